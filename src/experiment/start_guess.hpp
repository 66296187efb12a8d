// Values of states along a record, from its channels smoothed: where searches for start states begin.
#pragma once
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "data/experiment.hpp"
#include "regression/column/dictionary.hpp"
#include "regression/column/smoothing.hpp"

namespace sysid {

class StartGuess {
 public:
  /// experiments: with the dictionary's channels, equal steps. noise_sd: per channel.
  StartGuess(regression::Dictionary const& dictionary, std::span<Experiment const> experiments, std::vector<double> noise_sd);

  /// The derivative of given order of a state at a row, SI: from the highest measured one below it, by a spline through the channel
  /// that leaves the noise; 0 where none is measured or it is more than three orders below.
  double value(int experiment, int row, int state, int order);

 private:
  regression::Dictionary const& dictionary_;
  std::span<Experiment const> experiments_;
  std::vector<double> noise_sd_;
  struct Place {
    int experiment, channel, rise;
    auto operator<=>(Place const&) const = default;
  };
  std::map<Place, std::vector<double>> values_;
  std::map<std::pair<int, int>, regression::SmoothingSpline> splines_;  // by experiment and channel
};

}  // namespace sysid
