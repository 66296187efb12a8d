// Sorted, steps of one length follow one another.
#include "simulate/lengths/step_lengths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace sysid {
namespace {

// Of a part of a record whose steps are equal, no step differs from the part's mean by more than twice as much.
constexpr double tolerance_of_parts = 2.5e-6;
constexpr double of_a_step = 1e-9;  // the least difference of two lengths, relative

bool all_equal(std::span<double const> steps, double mean) {
  return std::ranges::all_of(steps, [&](double step) { return std::fabs(step - mean) <= tolerance_of_parts * mean; });
}

StepLengths of_one(double length, std::size_t samples) {
  return {{length}, std::vector<int>(samples), std::vector<int>(samples, static_cast<int>(samples))};
}

/// The most frequent first; of equally frequent ones the one that comes first.
void sort_by_frequency(StepLengths& lengths) {
  std::vector<int> order(lengths.values.size()), uses(order.size()), first(order.size());
  std::iota(order.begin(), order.end(), 0);
  for (std::size_t i = lengths.of.size(); i-- > 0;) {
    auto const length = static_cast<std::size_t>(lengths.of[i]);
    ++uses[length];
    first[length] = static_cast<int>(i);
  }
  std::ranges::sort(order, [&](int a, int b) {
    auto const p = static_cast<std::size_t>(a), q = static_cast<std::size_t>(b);
    return uses[p] != uses[q] ? uses[p] > uses[q] : first[p] < first[q];
  });
  std::vector<double> values;
  std::vector<int> place(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) {
    values.push_back(lengths.values[static_cast<std::size_t>(order[k])]);
    place[static_cast<std::size_t>(order[k])] = static_cast<int>(k);
  }
  lengths.values = std::move(values);
  for (int& each : lengths.of) each = place[static_cast<std::size_t>(each)];
}

}  // namespace

StepLengths step_lengths(std::span<double const> time) {
  std::size_t const samples = time.size();
  if (samples < 2) return of_one(0, samples);
  std::vector<double> steps;
  for (std::size_t i = 0; i + 1 < samples; ++i) steps.push_back(time[i + 1] - time[i]);
  double const mean = (time.back() - time.front()) / static_cast<double>(samples - 1);
  if (all_equal(steps, mean)) return of_one(mean, samples);

  double const latest = std::max(std::fabs(time.front()), std::fabs(time.back()));
  double const rounding = 4 * std::numeric_limits<double>::epsilon() * latest;
  std::vector<std::size_t> order(steps.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return steps[i]; });
  StepLengths result;
  result.of.resize(samples);
  for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
    double const shortest = steps[order[begin]];
    double sum = 0;
    for (; end < order.size() && steps[order[end]] - shortest <= std::max(rounding, of_a_step * shortest); ++end) {
      sum += steps[order[end]];
      result.of[order[end]] = static_cast<int>(result.values.size());
    }
    result.values.push_back(sum / static_cast<double>(end - begin));
  }
  result.of.back() = result.of[samples - 2];
  sort_by_frequency(result);
  result.until.assign(samples, static_cast<int>(samples));
  for (std::size_t i = samples - 1; i-- > 0;)
    result.until[i] = result.of[i] == result.of[i + 1] ? result.until[i + 1] : static_cast<int>(i) + 1;
  return result;
}

}  // namespace sysid
