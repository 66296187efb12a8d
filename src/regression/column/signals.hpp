// Properties of the records that every form needs: which channel measures what, steps, noise and the fastest period.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "data/experiment.hpp"
#include "regression/column/concern.hpp"
#include "regression/column/dictionary.hpp"

namespace sysid::regression {

/// The first channel that measures this derivative of the state; -1: none.
int channel_of(Dictionary const& dictionary, int state, int order);
/// The first channel of the highest measured derivative that is not above `order`; -1: none.
int base_channel(Dictionary const& dictionary, int state, int order);
/// The symbol of a leaf, or nullptr.
Symbol const* symbol_of(Dictionary const& dictionary, NodeId leaf);
/// Symbols below the roots, in the dictionary's order.
std::vector<Symbol> symbols_below(Dictionary const& dictionary, std::span<NodeId const> roots);
/// How many derivatives of a measured sample the equations need at most.
int derivatives_needed(Dictionary const& dictionary);
/// "y''": a state's name with its order as primes.
std::string symbol_text(Dictionary const& dictionary, int state, int order);

/// The step of a record whose steps agree to 1e-6; nothing otherwise.
std::optional<double> uniform_step(Experiment const& experiment);

/// sd of white noise on samples of a smooth signal, from sixth differences over runs without a missing sample (their sum of squared
/// weights is 924); 0 when there is no such run. A signal that moves from sample to sample counts as noise.
double estimated_noise(std::span<double const> samples);

/// Samples of a channel in one record.
struct ChannelSamples {
  std::span<double const> samples;
  std::span<double const> relative = {};  // sd of the noise of each sample, up to a factor; empty: 1
  bool equal_steps = true;                // else only differences are looked at
};
/// sd of the white noise of a channel where its relative noise is 1: from sixth differences, or from the quietest band of the
/// spectrum, where differences take fast motion for noise.
double estimated_noise(std::span<ChannelSamples const> records);

/// The period [s] below which 95 % of the power about the mean lies (Hann taper; missing samples bridged by straight lines);
/// infinite for a constant.
double fastest_period(std::span<double const> samples, double step);

/// noise_sd of every channel as given, else estimated over all experiments; at least 1e-9 of the channel's rms, so that made
/// records without noise keep a covariance.
std::vector<double> noise_of_channels(Dictionary const& dictionary, std::span<Experiment const> experiments);

/// A channel without samples, or one that does not move: fatal. `used`: channels of the equation.
Concerns channel_concerns(Dictionary const& dictionary, std::span<Experiment const> experiments, std::span<int const> used);
/// Beside these unequal steps and channels that contain nothing but noise, which no derivative can be had of.
Concerns record_concerns(Dictionary const& dictionary, std::span<Experiment const> experiments, std::span<int const> used);

/// Whether sample `row` can be used: scored, and none of the channels `used` missing.
bool usable(Experiment const& experiment, std::span<int const> used, int row);

/// Samples of an input as forms on samples and mixed terms see them: what acts at a sample. Under zero_order that is the mean of
/// the value held before and the one held after it; at the record's ends the one there is.
struct InputSides {
  std::vector<double> before, after;  // [N]: limits from the left and from the right
};
InputSides input_sides(InputSignal const& signal, int order);

}  // namespace sysid::regression
