// Lengths by the dominant period.
#include "discovery/validation_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "likelihood/segments/segments.hpp"
#include "regression/column/spectrum.hpp"

namespace sysid {
namespace {

constexpr int least_rows = 12;     // of a window or segment
constexpr int rows_per_state = 4;  // the same
constexpr int most_window = 200;
constexpr int windows_aside = 2;   // that rows must hold to be scored
constexpr int least_origins = 10;  // that forecasts of the horizon begin at

int rows_in(Experiment const& experiment) { return static_cast<int>(experiment.time.size()); }

/// Samples of the channel that has most of them in the last `last` rows.
int samples_in(Experiment const& experiment, int last) {
  std::ptrdiff_t most = 0;
  for (std::vector<double> const& channel : experiment.measured)
    if (!channel.empty())
      most = std::max(most, std::count_if(channel.end() - last, channel.end(), [](double y) { return std::isfinite(y); }));
  return static_cast<int>(most);
}

double dominant_period_of(std::vector<Experiment> const& records, double step) {
  std::vector<std::vector<double>> signals;
  for (Experiment const& each : records)
    for (std::vector<double> const& channel : each.measured)
      if (!channel.empty()) signals.push_back(channel);
  return regression::dominant_period(signals, step);
}

}  // namespace

ValidationRows validation_rows(std::vector<ExperimentData> const& task, std::vector<ExperimentData> const& unused, int states,
                               int half_width) {
  ValidationRows rows;
  for (ExperimentData const& each : task) rows.records.push_back(each.experiment);
  std::vector<double> const& time = rows.records.front().time;
  rows.step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  rows.horizon = std::max(1, static_cast<int>(std::lround(dominant_period_of(rows.records, rows.step) / rows.step)));
  int const least_window = std::max(least_rows, rows_per_state * states), needed = windows_aside * least_window;
  rows.least = std::max({2 * half_width, rows.horizon / 4, least_window});
  for (ExperimentData const& each : unused)
    if (samples_in(each.experiment, rows_in(each.experiment)) >= needed) rows.held_out.push_back(each.experiment);
  bool const unseen = !rows.held_out.empty();
  auto const holds = [&](int share) {
    return std::any_of(rows.records.begin(), rows.records.end(),
                       [&](Experiment const& each) { return samples_in(each, rows_in(each) / share) >= needed; });
  };
  int const share = holds(5) ? 5 : 4;  // a quarter where a fifth has too few rows
  for (Experiment const& each : rows.records) {
    int const count = rows_in(each), last = count / share;
    bool const cut = !unseen && samples_in(each, last) >= needed;
    rows.ends.push_back(cut ? count - last : count);
    if (cut) rows.held_out.push_back(slice(each, count - last, count));
    rows.cut = rows.cut || cut;
  }
  int shortest = std::numeric_limits<int>::max();
  for (Experiment const& each : rows.held_out) {
    rows.held_out_name += (rows.held_out_name.empty() ? (!rows.cut    ? ""
                                                         : share == 5 ? "the last fifth of "
                                                                      : "the last quarter of ")
                                                      : ", ") +
                          each.name;
    shortest = std::min(shortest, rows_in(each));
  }
  if (rows.held_out.empty()) return rows;
  rows.window = std::clamp(rows.horizon, least_window, std::max(least_window, std::min(most_window, shortest / 4)));
  rows.horizon = std::min(rows.horizon, std::max(1, shortest - rows.window - least_origins));
  return rows;
}

}  // namespace sysid
