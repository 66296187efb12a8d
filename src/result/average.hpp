// An averaged prediction: its members with their weights, and their scores beside those of the average.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/setting/average_weights.hpp"

namespace sysid {

/// A fit among those that are averaged.
struct AveragedMember {
  std::string fit, model;
  double weight = 0;
  std::optional<double> error;  // of the weight, one standard error; where it is known
  std::string counted;          // another fit of the same model, which has the weight of both
  int draws = 0;                // trajectories per record
};

/// On the samples of a channel of a record that all members predict.
struct AverageScores {
  double log_score = 0;  // mean over samples of the log predictive density, nats; of the declared unit
  double nmse = 0, rmse = 0, coverage_95 = 0;
};

struct AveragedChannel {
  std::string experiment, channel, unit;
  int samples = 0;  // that are scored
  AverageScores average;
  std::vector<AverageScores> members;
};

/// Shares of the variance of a quantity over a record, the scored samples where there are any; they sum to 1.
struct VarianceShares {
  std::string experiment, quantity, unit;
  double sd = 0;  // root of the mean variance
  double parameter = 0, model = 0, noise = 0;
};

struct AverageReport {
  AverageWeights weights = AverageWeights::evidence;
  std::vector<AveragedMember> members;
  std::vector<AveragedChannel> channels;
  std::vector<VarianceShares> shares;
};

}  // namespace sysid
