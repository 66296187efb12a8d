// Records for simulation tests.
#pragma once
#include <functional>
#include <utility>
#include <vector>

#include "data/experiment.hpp"

namespace sysid::testing {

inline std::vector<double> uniform_times(int samples, double step) {
  std::vector<double> time;
  for (int i = 0; i < samples; ++i) time.push_back(step * i);
  return time;
}

/// All rows scored; one channel per function of time.
inline Experiment experiment(std::vector<double> time, std::vector<std::function<double(double)>> const& inputs,
                             std::vector<std::function<double(double)>> const& channels, InputRule rule = InputRule::linear) {
  auto const sampled = [&](std::function<double(double)> const& f) {
    std::vector<double> values;
    for (double const t : time) values.push_back(f(t));
    return values;
  };
  Experiment result;
  for (auto const& input : inputs) result.inputs.emplace_back(rule, time, sampled(input));
  for (auto const& channel : channels) result.measured.push_back(sampled(channel));
  result.scored.assign(time.size(), 1);
  result.time = std::move(time);
  return result;
}

}  // namespace sysid::testing
