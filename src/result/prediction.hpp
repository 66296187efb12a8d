// The prediction of a model along a record: bands of posterior draws beside the measurements.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace sysid {

/// Pointwise over draws, each [N]; lower and upper: quantiles of 2.5 and 97.5 % by `predictive_quantile`. Empty: there is none.
struct Band {
  std::vector<double> mean, sd, lower, upper;
  int draws = 0, excluded = 0;  // of these so many, which it is not of
};

/// Where the variance of a prediction that averages over models comes from, each [N], in the square of the declared unit; their sum
/// is the variance with noise. Empty: there is none.
struct VarianceParts {
  std::vector<double> parameter;  // the mean over models of the variance over each one's draws
  std::vector<double> model;      // the variance over models of each one's mean
  std::vector<double> noise;      // the mean of the variances of the noise; empty where there is none
};

/// A channel, a state or a derived quantity along a record, declared unit.
struct PredictedQuantity {
  std::string name, unit;
  Band response;                    // of the model alone
  Band noisy;                       // with measurement noise added to each draw; empty for what is not measured
  std::vector<double> measured;     // [N], NaN where missing; empty for what is not measured
  VarianceParts variance = {};      // of an average over models
  bool average = false;             // at each sample the mean from there to the next
  bool logarithmic = false;         // of a channel whose noise multiplies it: scored by logarithms
  std::vector<double> alarms = {};  // times at which it was found to have changed, as in Prediction::time
};

/// What the record drives the model with, declared unit.
struct PredictedInput {
  std::string name, unit;
  std::vector<double> values;  // [N]
};

struct Prediction {
  std::string experiment;
  std::vector<double> time;          // [N] s, or row numbers
  std::string time_unit = "s";       // in which figures show it,
  double time_scale = 1;             // [s] one of these
  bool rows = false;                 // rows are independent: there is no time
  std::vector<std::uint8_t> scored;  // [N]
  std::vector<PredictedQuantity> quantities;
  std::vector<PredictedInput> inputs = {};  // in the model's order
  bool smoothed = false;                    // bands of what all samples say of random states, not of trajectories
};

}  // namespace sysid
