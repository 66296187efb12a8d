// The residuals of one channel of a fit over one experiment, and the results of their tests.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "data/experiment.hpp"
#include "diagnostics/residuals/residual_line.hpp"
#include "diagnostics/residuals/residual_tests.hpp"
#include "diagnostics/residuals/sized_residuals.hpp"
#include "model/model.hpp"

namespace sysid {

/// A channel over the scored rows of an experiment.
struct ChannelResiduals {
  Model const& of_model;
  std::vector<Experiment> const& experiments;
  int experiment, channel;
  std::vector<double> residuals;            // [N] standardised, NaN where not scored
  std::vector<double> observed, predicted;  // where scored, declared unit
  std::vector<std::size_t> places;          // of these along the experiment
  SizedResiduals sized;
  std::vector<std::string> widths_at_end = {};  // parameters of its noise that lie at the lower end of their prior

  Model const& model() const { return of_model; }
  Channel const& described() const { return model().channels[static_cast<std::size_t>(channel)]; }
  Experiment const& data() const { return experiments[static_cast<std::size_t>(experiment)]; }
  std::string name() const;                // "displacement on bench", where there are several experiments
  std::vector<std::string> names() const;  // that a finding concerns
  bool noise_is_estimated() const;
  int fitted() const;  // parameters that it may follow: all that are estimated
  /// [%], on the scale on which the noise has one size.
  double nmse_of(std::vector<double> const& some_observed, std::vector<double> const& some_predicted) const;
};

/// What tests of a channel find; not yet what that means, which depends on how many are tested.
struct ChannelTests {
  std::optional<double> start;   // sds of the first sample, where the model begins far from it: the first ones are left out, too
  std::vector<std::size_t> far;  // samples far off, left out of the tests
  double unexplained = 0;        // nmse [%] without spikes
  OffsetTest offset;
  double offset_size = 0, largest_offset = 0;  // of this channel, and of it on any experiment, in its declared unit
  TrendTest trend;                             // where there is no offset
  Trend line;
  std::optional<CorrelationTest> white;     // rows of any order have no past
  std::vector<CorrelationTest> with_input;  // of each input

  /// What to do first, where the fit explains something of the channel once the offset or the trend is estimated; else null.
  char const* first_cure() const;

  /// Whether the residuals are correlated by nothing else.
  bool white_otherwise() const { return (offset.fires && offset.white_without) || (trend.fires && trend.white_without); }
};

/// `residuals` with NaN at `places`.
std::vector<double> without(std::vector<double> residuals, std::vector<std::size_t> const& places);

ChannelTests test_channel(ChannelResiduals const& of);

}  // namespace sysid
