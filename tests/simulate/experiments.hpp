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

/// A gap every few samples at first, later no two steps of the same length.
inline std::vector<double> unequal_times(int samples, double step) {
  std::vector<double> time{0};
  for (int i = 1; i < samples; ++i) {
    double const part = i < samples / 3 ? (i % 5 == 0 ? 3 : i % 7 == 0 ? 0.5 : 1) : 0.6 + 0.0037 * ((37 * i) % 211);
    time.push_back(time.back() + step * part);
  }
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
