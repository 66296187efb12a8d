// Sorted draws merged, and moments weighed.
#include "criteria/mixture.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"

namespace sysid {
namespace {

/// sum_k w_k F_k just below x and at x, where the F_k jump at equal draws and at their ends.
struct Sides {
  double below = 0, at = 0;
};

double interpolated(std::span<double const> values, std::size_t before, double x) {
  auto const n = static_cast<double>(values.size());
  double const low = values[before - 1], high = values[before];
  return (static_cast<double>(before) + (x - low) / (high - low)) / (n + 1);
}

Sides cumulative(std::span<MixtureDraws const> members, double x) {
  Sides sides;
  for (MixtureDraws const& member : members) {
    std::span<double const> const values = member.values;
    auto const n = values.size();
    auto const less = static_cast<std::size_t>(std::lower_bound(values.begin(), values.end(), x) - values.begin());
    auto const up_to = static_cast<std::size_t>(std::upper_bound(values.begin(), values.end(), x) - values.begin());
    double below = 0, at = 0;
    if (less == up_to) {  // between two draws, or beyond all
      below = at = less == 0 ? 0 : less == n ? 1 : interpolated(values, less, x);
    } else {
      below = less == 0 ? 0 : static_cast<double>(less + 1) / static_cast<double>(n + 1);
      at = up_to == n ? 1 : static_cast<double>(up_to) / static_cast<double>(n + 1);
    }
    sides.below += member.weight * below;
    sides.at += member.weight * at;
  }
  return sides;
}

}  // namespace

double mixture_quantile(std::span<MixtureDraws const> members, double probability) {
  // The first draw of all where the sum reaches the probability, and the last before it; each member's draws are in order.
  double found = std::numeric_limits<double>::infinity(), last = -found, before = -found;
  for (MixtureDraws const& member : members) {
    auto const reached = std::partition_point(member.values.begin(), member.values.end(),
                                              [&](double x) { return cumulative(members, x).at < probability; });
    if (reached != member.values.end()) found = std::min(found, *reached);
    last = std::max(last, member.values.back());
  }
  if (found > last) return last;  // the weights may sum to 1 but for rounding
  for (MixtureDraws const& member : members) {
    auto const first = std::lower_bound(member.values.begin(), member.values.end(), found);
    if (first != member.values.begin()) before = std::max(before, *(first - 1));
  }
  Sides const here = cumulative(members, found);
  if (!std::isfinite(before) || here.below <= probability) return found;
  double const reached = cumulative(members, before).at;
  return before + (found - before) * (probability - reached) / (here.below - reached);
}

VarianceSplit split_variance(std::span<MemberMoments const> members) {
  VarianceSplit split;
  for (MemberMoments const& each : members) split.mean += each.weight * each.mean;
  for (MemberMoments const& each : members) {
    split.parameter += each.weight * each.variance;
    split.model += each.weight * (each.mean - split.mean) * (each.mean - split.mean);
    split.noise += each.weight * each.noise;
  }
  return split;
}

VarianceSplit split_pooled(std::span<std::vector<double> const> groups) {
  double all = 0;
  for (std::vector<double> const& group : groups) all += static_cast<double>(group.size());
  std::vector<MemberMoments> members;
  for (std::vector<double> const& group : groups)
    if (!group.empty()) members.push_back({static_cast<double>(group.size()) / all, mean(group), population_variance(group), 0});
  VarianceSplit split = split_variance(members);
  split.parameter *= all / (all - 1);
  split.model *= all / (all - 1);
  return split;
}

double log_mixture_density(std::span<double const> weights, std::span<double const> log_density) {
  double largest = -std::numeric_limits<double>::infinity(), sum = 0;
  for (std::size_t k = 0; k < weights.size(); ++k)
    if (weights[k] > 0) largest = std::max(largest, log_density[k]);
  if (!std::isfinite(largest)) return largest;
  for (std::size_t k = 0; k < weights.size(); ++k)
    if (weights[k] > 0) sum += weights[k] * elementary::exp(log_density[k] - largest);
  return largest + elementary::log(sum);
}

}  // namespace sysid
