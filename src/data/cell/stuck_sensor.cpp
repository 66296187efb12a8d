// Differences of neighbours outside of the runs say what the record is like.
#include "data/cell/stuck_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr std::size_t fewest_samples = 60;
constexpr double most_repeated = 0.05;  // of the other samples
constexpr double rough = 0.3;           // second differences by first ones: 1.7 of white noise
constexpr double gentle = 0.2;          // of the usual difference: a motion that dies out

/// Without those that are missing.
struct Present {
  std::vector<double> values;
  std::vector<std::size_t> places;
};
Present present(std::span<double const> values) {
  Present all;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (std::isnan(values[i])) continue;
    all.values.push_back(values[i]);
    all.places.push_back(i);
  }
  return all;
}

struct EqualRun {
  std::size_t begin = 0, end = 0;
};
std::vector<EqualRun> equal_runs(std::vector<double> const& values) {
  std::vector<EqualRun> runs;
  for (std::size_t i = 0; i < values.size();) {
    std::size_t end = i + 1;
    while (end < values.size() && values[end] == values[i]) ++end;
    runs.push_back({i, end});
    i = end;
  }
  return runs;
}

/// The usual difference of neighbours outside of `runs`; 0 where the record is smooth there, or repeats itself.
double usual_difference(std::vector<double> const& values, std::vector<EqualRun> const& runs) {
  std::vector<double> first, second;
  std::size_t repeated = 0;
  auto run = runs.begin();
  for (std::size_t i = 2; i < values.size(); ++i) {
    while (run != runs.end() && run->end + 1 < i) ++run;
    if (run != runs.end() && i >= run->begin && i < run->end + 2) continue;
    double const difference = values[i] - values[i - 1];
    repeated += difference == 0;
    first.push_back(std::fabs(difference));
    second.push_back(std::fabs(difference - (values[i - 1] - values[i - 2])));
  }
  if (first.size() < fewest_samples / 2) return 0;
  if (static_cast<double>(repeated) > most_repeated * static_cast<double>(first.size())) return 0;
  double const usual = median(first);
  return median(second) < rough * usual ? 0 : usual;
}

/// The middle one of the differences just before a run.
double difference_before(std::vector<double> const& values, std::size_t begin) {
  constexpr std::size_t looked_at = 10;
  std::vector<double> before;
  for (std::size_t i = begin - std::min(begin, looked_at) + 1; i < begin; ++i)
    before.push_back(std::fabs(values[i] - values[i - 1]));
  return before.empty() ? 0 : median(before);
}

}  // namespace

std::optional<FrozenRun> frozen_run(std::span<double const> values) {
  constexpr std::size_t fewest = 20, part = 10;
  Present const all = present(values);
  if (all.values.size() < fewest_samples) return std::nullopt;
  std::vector<EqualRun> const runs = equal_runs(all.values);
  EqualRun const longest =
      *std::max_element(runs.begin(), runs.end(), [](EqualRun a, EqualRun b) { return a.end - a.begin < b.end - b.begin; });
  std::size_t const samples = longest.end - longest.begin;
  if (longest.begin == 0 || samples < fewest || samples * part < all.values.size()) return std::nullopt;
  double const usual = usual_difference(all.values, {longest});
  if (usual == 0 || difference_before(all.values, longest.begin) < gentle * usual) return std::nullopt;
  return FrozenRun{all.places[longest.begin], all.places[longest.end - 1], samples, all.values[longest.begin]};
}

std::optional<ClippedSamples> clipped_samples(std::span<double const> values) {
  constexpr std::size_t shortest = 3, fewest = 10, part = 50;
  Present const all = present(values);
  if (all.values.size() < fewest_samples) return std::nullopt;
  std::vector<EqualRun> const runs = equal_runs(all.values);
  auto const [smallest, largest] = std::minmax_element(all.values.begin(), all.values.end());
  for (double const end : {*largest, *smallest}) {
    ClippedSamples clipped{end, end == *largest, {}};
    std::vector<EqualRun> there;
    std::vector<double> before;
    for (EqualRun const& run : runs) {
      if (run.begin == 0 || run.end - run.begin < shortest || all.values[run.begin] != end) continue;
      there.push_back(run);
      before.push_back(difference_before(all.values, run.begin));
      for (std::size_t i = run.begin; i < run.end; ++i) clipped.places.push_back(all.places[i]);
    }
    if (end == 0 || clipped.places.size() < fewest || clipped.places.size() * part < all.values.size()) continue;
    double const usual = usual_difference(all.values, there);
    if (usual > 0 && median(before) >= gentle * usual) return clipped;
  }
  return std::nullopt;
}

}  // namespace sysid
