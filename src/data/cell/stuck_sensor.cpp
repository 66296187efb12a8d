// Differences of neighbours outside of the runs say what the record is like.
#include "data/cell/stuck_sensor.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

constexpr std::size_t fewest_samples = 60;
constexpr double most_repeated = 0.05;     // of the other samples
constexpr double rough = 0.3;              // second differences by first ones: 1.7 of white noise
constexpr double gentle = 0.2;             // of the usual difference: a motion that dies out
constexpr double hardly_repeated = 0.005;  // of the other samples: a few equal ones in a row are then no chance

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

/// What the record is like outside of `runs`.
struct Elsewhere {
  double difference = 0;  // the usual one of neighbours; 0 where the record repeats itself, or little of it is left
  double roughness = 0;   // second differences by first ones
  double repeated = 0;    // the part of the samples that repeat the one before
};
Elsewhere elsewhere(std::vector<double> const& values, std::vector<EqualRun> const& runs) {
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
  if (first.size() < fewest_samples / 2) return {};
  double const part_repeated = static_cast<double>(repeated) / static_cast<double>(first.size());
  if (part_repeated > most_repeated) return {};
  double const usual = median(first);
  return {usual, usual > 0 ? median(second) / usual : 0, part_repeated};
}

/// The middle one of the differences just before a run; without those where the record stands at `end`, too.
double difference_before(std::vector<double> const& values, std::size_t begin, std::optional<double> end = std::nullopt) {
  constexpr std::size_t looked_at = 10;
  std::vector<double> before;
  for (std::size_t i = begin - std::min(begin, looked_at) + 1; i < begin; ++i)
    if (!(values[i] == end && values[i - 1] == end)) before.push_back(std::fabs(values[i] - values[i - 1]));
  return before.empty() ? 0 : median(before);
}

/// The least distance of the numbers next to an end of the range: the step of a converter, or of the printed digits there.
double step_near(std::vector<double> const& sorted, bool largest) {
  constexpr std::size_t looked_at = 10;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i + 1 < std::min(sorted.size(), looked_at); ++i) {
    std::size_t const at = largest ? sorted.size() - 1 - i : i + 1;
    least = std::min(least, sorted[at] - sorted[at - 1]);
  }
  return least;
}

/// Whether a smooth record is cut off in each of several runs: it arrives at the end in many steps of the numbers there, where a
/// rounded peak arrives in one to four, and as fast as it moves elsewhere.
bool cut_off(std::vector<double> const& values, std::vector<EqualRun> const& runs, Elsewhere const& rest, double step) {
  constexpr std::size_t fewest_runs = 3;
  constexpr double curved = 1e-3, steps = 8;  // straight lines between two stops are a motion that was asked for
  if (runs.size() < fewest_runs || rest.roughness < curved) return false;
  std::vector<double> arrivals;
  for (EqualRun const& run : runs)
    if (run.begin > 1) arrivals.push_back(std::fabs(values[run.begin - 1] - values[run.begin - 2]));
  double const arrival = arrivals.empty() ? 0 : median(arrivals);
  return arrival >= steps * step && arrival >= gentle * rest.difference;
}

/// Whether a run is much longer than all others, and at neither end of the range: what stands there now and then does so again, and
/// a short stop at an end has many reasons.
bool stands_out(std::vector<double> const& values, std::vector<EqualRun> const& runs, EqualRun longest) {
  constexpr std::size_t longer = 5;  // than the second longest
  auto const [smallest, largest] = std::minmax_element(values.begin(), values.end());
  double const value = values[longest.begin];
  if (value == *smallest || value == *largest) return false;
  return std::all_of(runs.begin(), runs.end(), [&](EqualRun const& run) {
    return run.begin == longest.begin || longer * (run.end - run.begin) <= longest.end - longest.begin;
  });
}

}  // namespace

std::optional<FrozenRun> frozen_run(std::span<double const> values) {
  constexpr std::size_t fewest = 10, fewest_of_many = 20, part = 10;
  Present const all = present(values);
  if (all.values.size() < fewest_samples) return std::nullopt;
  std::vector<EqualRun> const runs = equal_runs(all.values);
  EqualRun const longest =
      *std::max_element(runs.begin(), runs.end(), [](EqualRun a, EqualRun b) { return a.end - a.begin < b.end - b.begin; });
  std::size_t const samples = longest.end - longest.begin;
  if (longest.begin == 0 || samples < fewest) return std::nullopt;
  bool const large = samples >= fewest_of_many && samples * part >= all.values.size();
  if (!large && !stands_out(all.values, runs, longest)) return std::nullopt;
  Elsewhere const rest = elsewhere(all.values, {longest});
  if (!large && rest.repeated > hardly_repeated) return std::nullopt;
  if (rest.difference == 0 || rest.roughness < rough || difference_before(all.values, longest.begin) < gentle * rest.difference)
    return std::nullopt;
  return FrozenRun{all.places[longest.begin], all.places[longest.end - 1], samples, all.values[longest.begin]};
}

std::vector<ClippedSamples> clipped_samples(std::span<double const> values) {
  constexpr std::size_t shortest = 3, fewest = 10, part = 50, fewest_of_different = 5;
  Present const all = present(values);
  if (all.values.size() < fewest_samples) return {};
  auto const [smallest, largest] = std::minmax_element(all.values.begin(), all.values.end());
  std::vector<EqualRun> at_ends;
  for (EqualRun const& run : equal_runs(all.values)) {
    double const value = all.values[run.begin];
    if (run.end - run.begin >= shortest && value != 0 && (value == *largest || value == *smallest)) at_ends.push_back(run);
  }
  Elsewhere const rest = elsewhere(all.values, at_ends);
  if (rest.difference == 0) return {};
  std::vector<double> sorted = all.values;
  std::sort(sorted.begin(), sorted.end());
  sorted.erase(std::unique(sorted.begin(), sorted.end()), sorted.end());
  std::vector<ClippedSamples> ends;
  for (double const end : {*largest, *smallest}) {
    ClippedSamples clipped{end, end == *largest, {}};
    std::vector<EqualRun> there;
    std::vector<double> before;
    for (EqualRun const& run : at_ends) {
      if (run.begin == 0 || all.values[run.begin] != end) continue;
      there.push_back(run);
      before.push_back(difference_before(all.values, run.begin, end));
      for (std::size_t i = run.begin; i < run.end; ++i) clipped.places.push_back(all.places[i]);
    }
    bool const many = clipped.places.size() >= fewest && clipped.places.size() * part >= all.values.size();
    bool const no_chance =
        clipped.places.size() >= fewest_of_different && rest.repeated <= hardly_repeated && rest.roughness >= rough;
    if (!many && !no_chance) continue;
    if (rest.roughness < rough ? cut_off(all.values, there, rest, step_near(sorted, clipped.largest))
                               : median(before) >= gentle * rest.difference)
      ends.push_back(std::move(clipped));
  }
  return ends;
}

}  // namespace sysid
