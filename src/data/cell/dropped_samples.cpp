// A signal that passes through zero does so near its neighbours; a lost sample is zero wherever the signal is.
#include "data/cell/dropped_samples.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr std::size_t longest_run = 3, least_dropped = 3, least_levels = 10;
constexpr double most_zeros = 0.2, most_of_others = 0.9, times_farther = 3;

bool has_levels(std::vector<double> const& values) {
  std::set<double> levels;
  for (double const value : values)
    if (!std::isnan(value) && value != 0 && levels.insert(value).second && levels.size() >= least_levels) return true;
  return false;
}

/// How far samples lie from the straight line between two neighbours that are no zeros.
struct Distances {
  std::vector<double> of_others;
  struct Run {
    double distance = 0;       // of the zero in it that is farthest
    double from_one_side = 0;  // of the first from the line through the two samples before it, or of the last from that behind it
    std::size_t zeros = 0;
  };
  std::vector<Run> of_zeros;  // of runs that are short
};

/// Of a zero from the line through two samples, the nearer one first; where one is missing it is far.
double extrapolated(double near, double next) {
  double const distance = std::fabs(2 * near - next);
  return std::isnan(distance) ? infinity : distance;
}

Distances distances_in(std::vector<double> const& values) {
  Distances all;
  auto const counts = [&](std::size_t i) { return i < values.size() && !std::isnan(values[i]) && values[i] != 0; };
  for (std::size_t i = 1; i + 1 < values.size(); ++i) {
    if (!counts(i - 1)) continue;
    if (counts(i)) {
      if (counts(i + 1)) all.of_others.push_back(std::fabs(values[i] - (values[i - 1] + values[i + 1]) / 2));
      continue;
    }
    std::size_t end = i;
    while (end < values.size() && values[end] == 0) ++end;
    if (end == i || end - i > longest_run || !counts(end)) continue;
    double const before = i > 1 ? extrapolated(values[i - 1], values[i - 2]) : infinity,
                 behind = end + 1 < values.size() ? extrapolated(values[end], values[end + 1]) : infinity;
    Distances::Run run{0, std::min(before, behind), end - i};
    for (std::size_t k = i; k < end; ++k) {
      double const share = static_cast<double>(k - i + 1) / static_cast<double>(run.zeros + 1);
      run.distance = std::max(run.distance, std::fabs(values[i - 1] + share * (values[end] - values[i - 1])));
    }
    all.of_zeros.push_back(run);
  }
  return all;
}

}  // namespace

std::vector<std::size_t> dropped_samples(std::vector<double> const& values) {
  auto const zeros = static_cast<std::size_t>(std::count(values.begin(), values.end(), 0.0));
  if (zeros < least_dropped || static_cast<double>(zeros) >= most_zeros * static_cast<double>(values.size())) return {};
  if (!has_levels(values)) return {};
  Distances all = distances_in(values);
  if (all.of_others.empty()) return {};
  double const far = times_farther * quantile(std::move(all.of_others), most_of_others);
  std::size_t dropped = 0;
  for (Distances::Run const& run : all.of_zeros)
    if (run.distance > far && run.from_one_side > far) dropped += run.zeros;
  if (dropped < least_dropped || 2 * dropped < zeros) return {};
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < values.size(); ++i)
    if (values[i] == 0) places.push_back(i);
  return places;
}

}  // namespace sysid
