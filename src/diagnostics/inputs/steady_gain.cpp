// Successive parts of a record as repetitions of one experiment: a ratio of sums over them, with Student's test.
#include "diagnostics/inputs/steady_gain.hpp"

#include <cmath>
#include <cstddef>
#include <numeric>

namespace sysid {
namespace {

constexpr std::size_t most_parts = 16, least_parts = 8;
/// 99.7 % of Student's t by degrees of freedom, 7 to 15.
constexpr double limit_by_parts[] = {3.89, 3.70, 3.57, 3.47, 3.39, 3.33, 3.28, 3.23, 3.20};

struct RecordPart {
  double gain = 0, difference = 0;
};

std::vector<RecordPart> parts_of(std::vector<double> const& gains, std::vector<double> const& differences) {
  double const all = std::accumulate(differences.begin(), differences.end(), 0.0);
  std::vector<RecordPart> parts(1);
  double before = 0;
  for (std::size_t k = 0; k < gains.size(); ++k) {
    // A part ends before the next row where the inputs differ, so that it has the whole response to its own differences.
    if (differences[k] > 0 && parts.back().difference >= all / most_parts && before < all) parts.emplace_back();
    parts.back().gain += gains[k];
    parts.back().difference += differences[k];
    before += differences[k];
  }
  return parts;
}

}  // namespace

bool steady_gain(std::vector<double> const& gains, std::vector<double> const& differences) {
  std::vector<RecordPart> parts = parts_of(gains, differences);
  double const all = std::accumulate(differences.begin(), differences.end(), 0.0);
  if (!(all > 0)) return false;
  // What is left at the end is too small to be a part of its own.
  if (parts.size() > 1 && parts.back().difference < 0.5 * all / most_parts) {
    parts[parts.size() - 2].gain += parts.back().gain;
    parts[parts.size() - 2].difference += parts.back().difference;
    parts.pop_back();
  }
  if (parts.size() < least_parts) return false;
  double gain = 0, square = 0;
  for (RecordPart const& part : parts) gain += part.gain;
  double const per_difference = gain / all;
  for (RecordPart const& part : parts) {
    double const left = part.gain - per_difference * part.difference;
    square += left * left / part.difference;
  }
  double const variance = square / static_cast<double>(parts.size() - 1);
  return gain > limit_by_parts[parts.size() - least_parts] * std::sqrt(variance * all);
}

}  // namespace sysid
