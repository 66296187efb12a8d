// Trajectories of posterior draws condensed to bands, with and without noise, beside what was measured; and their scores.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace sysid {

/// Pointwise over draws, each [N]; q2.5 and q97.5 are `predictive_quantile`s. Empty: there is none.
struct Band {
  std::vector<double> mean, sd, lower, upper;
  int draws = 0, left_out = 0;  // of these so many, which it is not of
};

/// trajectories[d][i]: draw d at sample i; a draw that failed (a value that is not finite where another draw's is) is left out, and
/// counted. NaN at samples where no draw is finite; empty when no draw is left.
Band band(std::vector<std::vector<double>> const& trajectories);

/// A channel, a state or a derived quantity along a record, declared unit.
struct PredictedQuantity {
  std::string name, unit;
  Band response;                 // of the model alone
  Band noisy;                    // with measurement noise added to each draw; empty for what is not measured
  std::vector<double> measured;  // [N], NaN where missing; empty for what is not measured
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
};

struct Score {
  std::string name;
  double value;
};

/// Of a measured quantity over the scored samples that are there; empty when there are none:
///   nmse         100/(n s^2) sum (y_i - mean_i)^2, s^2 the population variance of the measured y      Worden et al., eq. 8.18
///   rmse         sqrt(1/n sum (y_i - mean_i)^2), in the quantity's unit
///   coverage_95  share of y_i inside [q2.5, q97.5] with noise          (only when there is a band with noise)
///   coverage_3sd share of y_i within three sd with noise of the mean   (the same)
std::vector<Score> scores(PredictedQuantity const& quantity, std::vector<std::uint8_t> const& scored);

}  // namespace sysid
