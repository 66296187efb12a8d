// Rounds of walking, fitting and weighting.
#include "inference/evidence/walked_draws.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/generalised_pareto.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "inference/evidence/ensemble_walk.hpp"
#include "inference/evidence/mixture.hpp"
#include "search/laplace.hpp"

namespace sysid::marginal {
namespace {

constexpr int most_walks = 8, draws_per_walk = 800;
constexpr double worst_k = 0.7, least_effective = 250;  // effective draws
// Of the logarithm of a ratio of sds: of so many walkers it scatters by a tenth, of the draws of two rounds by less.
constexpr double as_wide = 0.25, as_before = 0.1;
constexpr std::uint64_t steps_of_round = 1000;  // of the key; more than a round walks

LaneArray appended(LaneArray const& left, LaneArray const& right) {
  LaneArray out(right.rows(), left.width() + right.width());
  for (int i = 0; i < right.rows(); ++i) {
    if (left.width() > 0) std::ranges::copy(left.row(i), out.row(i).begin());
    std::ranges::copy(right.row(i), out.row(i).begin() + left.width());
  }
  return out;
}

/// Log densities under the mixture of all, each of which gave as many draws.
std::vector<double> log_mixed(std::vector<Mixture> const& mixtures, ConstLanes theta) {
  std::vector<double> mixed(static_cast<std::size_t>(theta.width()), -infinity);
  for (Mixture const& mixture : mixtures) {
    std::vector<double> const one = mixture.log_density(mixture.log_terms(theta));
    for (std::size_t d = 0; d < mixed.size(); ++d) mixed[d] = log_of_sum(mixed[d], one[d]);
  }
  double const count = elementary::log(static_cast<double>(mixtures.size()));
  for (double& each : mixed) each -= count;
  return mixed;
}

/// Of each row, with weights that do not sum to anything; empty: all alike.
std::vector<double> sds_of(LaneArray const& values, std::vector<double> const& weights) {
  auto const weight = [&](std::size_t k) { return weights.empty() ? 1.0 : weights[k]; };
  std::vector<double> sds;
  for (int i = 0; i < values.rows(); ++i) {
    auto const row = values.row(i);
    double sum = 0, mean = 0, square = 0;
    for (std::size_t k = 0; k < row.size(); ++k) sum += weight(k), mean += weight(k) * row[k];
    mean /= sum;
    for (std::size_t k = 0; k < row.size(); ++k) square += weight(k) * (row[k] - mean) * (row[k] - mean);
    sds.push_back(std::sqrt(square / sum));
  }
  return sds;
}

bool agree(std::vector<double> const& one, std::vector<double> const& other, double apart) {
  if (one.size() != other.size()) return false;  // there is no round before the first
  for (std::size_t i = 0; i < one.size(); ++i)
    if (!(std::fabs(elementary::log(one[i] / other[i])) < apart)) return false;
  return true;
}

LaneArray declared(Target const& target, LaneArray const& theta) {
  LaneArray values(theta.rows(), theta.width());
  target.constrain(theta, values);
  return values;
}

/// Whether means with such weights are to be believed. Widths are compared in declared values: a tail that is thin in a logarithm
/// may hold most of a variance. `before`: the widths of the round before; changed to those of this one. The weights, where they are
/// healthy, believed or not; else none.
std::vector<double> judge(Target const& target, WalkedDraws& draws, std::vector<double>& before) {
  double const largest = *std::max_element(draws.log_weights.begin(), draws.log_weights.end());
  draws.confirmed = false;
  draws.effective = 0;
  std::vector<double> weights;
  if (!std::isfinite(largest)) return weights;
  for (double const each : draws.log_weights) weights.push_back(elementary::exp(each - largest));
  draws.effective = effective_number(weights);
  double const k = smooth_weights(draws.log_weights, pareto_tail_length(draws.theta.width(), 1)).k;
  std::vector<double> const sds = sds_of(declared(target, draws.theta), weights);
  bool const healthy = draws.effective >= least_effective && k < worst_k;
  draws.confirmed = healthy && agree(sds, before, as_before) && agree(sds, sds_of(declared(target, draws.walked), {}), as_wide);
  before = sds;
  return healthy ? weights : std::vector<double>();
}

/// A walker that has strayed into a place of next to no mass may stay there, and be one of them all: the mixture that was fitted to
/// it has far too many draws there, as their weights show. It goes to a weighted draw. Where the mixture has too few, walkers stay.
void gather(Objective const& objective, WalkedDraws const& draws, std::vector<double> const& weights,
            std::vector<Mixture> const& mixtures, LaneArray& walkers, Ledger& ledger) {
  constexpr double far_too_many = 100;
  double sum = 0;
  for (double const each : weights) sum += each;
  double const mean = *std::max_element(draws.log_weights.begin(), draws.log_weights.end()) +
                      elementary::log(sum / static_cast<double>(weights.size()));
  std::vector<double> const density = log_density_in_blocks(objective, walkers, ledger), mixed = log_mixed(mixtures, walkers);
  LaneArray const home = resampled(draws.theta, weights, walkers.width());
  for (int w = 0; w < walkers.width(); ++w) {
    auto const at = static_cast<std::size_t>(w);
    if (density[at] - mixed[at] > mean - elementary::log(far_too_many)) continue;
    for (int i = 0; i < walkers.rows(); ++i) walkers(i, w) = home(i, w);
  }
}

LaneArray last_of(LaneArray const& states, int count) { return LaneArray(states.view().columns(states.width() - count, count)); }

}  // namespace

LaneArray resampled(LaneArray const& draws, std::vector<double> const& weights, int count) {
  double total = 0;
  for (double const each : weights) total += each;
  LaneArray out(draws.rows(), count);
  std::size_t at = 0;
  double passed = weights.front();
  for (int w = 0; w < count; ++w) {
    while (at + 1 < weights.size() && (w + 0.5) / count * total > passed) passed += weights[++at];
    for (int i = 0; i < out.rows(); ++i) out(i, w) = draws(i, static_cast<int>(at));
  }
  return out;
}

WalkedDraws walked_draws(Objective const& objective, LaneArray walkers, std::uint64_t most, StreamKey key, Ledger& ledger,
                         std::function<bool()> const& stop) {
  auto const stopped = [&] { return stop && stop(); };
  int const steps = long_walk(objective.dimension());
  std::uint64_t const cost = static_cast<std::uint64_t>(steps + 1) * static_cast<std::uint64_t>(walkers.width()) + draws_per_walk;
  WalkedDraws found;
  std::vector<Mixture> mixtures;
  std::vector<double> sds;
  if (2 * cost > most) return found;
  StreamKey const apart = key.with_step(key.step + most_walks * steps_of_round);
  walkers = last_of(walk(objective, walkers, steps / 2, apart, ledger, stopped, spreading_power), walkers.width());
  for (int round = 0; round < most_walks && !found.confirmed && !stopped(); ++round) {
    if (static_cast<std::uint64_t>(round + 2) * cost > most) break;
    StreamKey const here = key.with_step(key.step + static_cast<std::uint64_t>(round) * steps_of_round);
    LaneArray states = walk(objective, walkers, steps, here, ledger, stopped);
    Mixture mixture = fit_mixture({}, states, key.seed, stopped);
    if (mixture.empty() || stopped()) break;
    walkers = last_of(states, walkers.width());
    LaneArray more(objective.dimension(), draws_per_walk);
    StreamKey const drawn = here.with_step(here.step + steps_of_round - 1);
    for (int d = 0; d < draws_per_walk; ++d) mixture.draw(drawn.with_index(static_cast<std::uint64_t>(d)), more, d);
    std::vector<double> const density = log_density_in_blocks(objective, more, ledger, stopped);
    found.log_density.insert(found.log_density.end(), density.begin(), density.end());
    found.theta = appended(found.theta, more);
    mixtures.push_back(std::move(mixture));
    found.log_weights = found.log_density;
    std::vector<double> const mixed = log_mixed(mixtures, found.theta);
    for (std::size_t d = 0; d < mixed.size(); ++d)
      found.log_weights[d] = std::isfinite(mixed[d]) ? found.log_weights[d] - mixed[d] : -infinity;
    found.walked = std::move(states);
    std::vector<double> const weights = judge(objective.target, found, sds);
    if (!weights.empty() && !found.confirmed && !stopped()) gather(objective, found, weights, mixtures, walkers, ledger);
  }
  return found;
}

}  // namespace sysid::marginal
