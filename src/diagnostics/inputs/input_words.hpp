// Findings about delays of inputs and about the rule between their samples, in words.
#pragma once
#include <string>

#include "data/experiment.hpp"
#include "data/input_rule.hpp"
#include "model/model.hpp"
#include "result/finding.hpp"

namespace sysid {

/// An input of an experiment. on: how messages name the experiment, " on bench"; empty where there is one only.
struct InputOf {
  Model const& model;
  Experiment const& experiment;
  std::size_t index;
  std::string on;
};

/// gain: of log density; scored: samples. The rule that explains the record better than the stated one.
Finding other_rule(InputOf const& input, InputRule better, double gain, int scored);
/// `linear` on a smooth input, of which `cubic` moves a parameter by so many sds.
Finding smooth_input(InputOf const& input, std::string const& parameter, double sds);
/// Of a shift in whole samples; of more nothing is known.
inline constexpr int most_samples = 5;
/// shift: samples later, of which half ones are possible; in continuous time.
Finding other_timing(InputOf const& input, double shift, double gain, int scored);
/// The same in discrete time, where the equation states lags.
Finding other_lag(InputOf const& input, int later, double gain, int scored);

}  // namespace sysid
