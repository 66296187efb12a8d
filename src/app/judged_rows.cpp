// Lengths by the dominant period.
#include "app/judged_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "likelihood/segments.hpp"
#include "regression/spectrum.hpp"

namespace sysid {
namespace {

constexpr int least_rows = 12;     // of a window or segment
constexpr int rows_per_state = 4;  // the same
constexpr int most_window = 200;
constexpr int windows_aside = 3;  // that rows must hold to be scored

int rows_in(Experiment const& experiment) { return static_cast<int>(experiment.time.size()); }

double dominant_period_of(std::vector<Experiment> const& records, double step) {
  std::vector<std::vector<double>> signals;
  for (Experiment const& each : records)
    for (std::vector<double> const& channel : each.measured)
      if (!channel.empty()) signals.push_back(channel);
  return regression::dominant_period(signals, step);
}

}  // namespace

JudgedRows judged_rows(std::vector<ExperimentData> const& task, std::vector<ExperimentData> const& unused, int states,
                       int half_width) {
  JudgedRows rows;
  for (ExperimentData const& each : task) rows.records.push_back(each.experiment);
  std::vector<double> const& time = rows.records.front().time;
  rows.step = (time.back() - time.front()) / static_cast<double>(time.size() - 1);
  rows.horizon = std::max(1, static_cast<int>(std::lround(dominant_period_of(rows.records, rows.step) / rows.step)));
  int const least_window = std::max(least_rows, rows_per_state * states), needed = windows_aside * least_window;
  rows.least = std::max({2 * half_width, rows.horizon / 4, least_window});
  for (ExperimentData const& each : unused)
    if (rows_in(each.experiment) >= needed) rows.aside.push_back(each.experiment);
  rows.cut = rows.aside.empty() && std::all_of(rows.records.begin(), rows.records.end(),
                                               [&](Experiment const& each) { return rows_in(each) / 5 >= needed; });
  for (Experiment const& each : rows.records) {
    int const count = rows_in(each), last = rows.cut ? count / 5 : 0;
    rows.ends.push_back(count - last);
    if (rows.cut) rows.aside.push_back(rows_of(each, count - last, last));
  }
  int shortest = std::numeric_limits<int>::max();
  for (Experiment const& each : rows.aside) {
    rows.aside_name += (rows.aside_name.empty() ? (rows.cut ? "the last fifth of " : "") : ", ") + each.name;
    shortest = std::min(shortest, rows_in(each));
  }
  if (rows.aside.empty()) return rows;
  rows.window = std::clamp(rows.horizon, least_window, std::max(least_window, std::min(most_window, shortest / 4)));
  rows.horizon = std::min(rows.horizon, shortest - rows.window - 1);
  return rows;
}

}  // namespace sysid
