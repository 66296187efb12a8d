// Importance sampling on the sampler's coordinates.
#include "app/fit/earlier_posterior.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "inference/evidence/ensemble_walk.hpp"
#include "inference/evidence/mixture.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr int most_parameters = 40;
constexpr int most_rounds = 2;
constexpr double good_k = 0.3;  // above it, errors of the scores are stated too small
constexpr double share_of_wide = 0.2;
constexpr std::uint64_t first_step = 8'000'000;  // of Purpose::start
constexpr std::uint64_t steps_of_record = 1'000'000'000'000, steps_of_rows = 1000;

/// Student's t at the modes. Some are twice as wide: along a curved ridge weights are largest beyond the ends of its normal
/// approximation.
marginal::Mixture at_modes(std::vector<Mode> const& modes) {
  std::vector<marginal::Mixture::Part> parts;
  double heaviest = -infinity, sum = 0;
  for (Mode const& mode : modes) heaviest = std::max(heaviest, mode.log_mass);
  for (Mode const& mode : modes) {
    double const share = elementary::exp(mode.log_mass - heaviest);
    Component shape(theta_of(mode), covariance_of(mode));
    if (!(share > 1e-3) || !(shape.root.diagonal().array() > 0).all()) continue;
    sum += share;
    parts.push_back({Component(shape.centre, 4 * covariance_of(mode)), 0, share_of_wide * share});
    parts.push_back({std::move(shape), 0, (1 - share_of_wide) * share});
  }
  for (marginal::Mixture::Part& part : parts) part.student /= sum;
  return marginal::Mixture(std::move(parts));
}

/// Draws of mixtures, one for each round, that count against all of them together.
class Rounds {
 public:
  Rounds(Objective const& objective, int draws, StreamKey key) : objective_(objective), draws_(draws), key_(key) {}

  void add(marginal::Mixture mixture, Ledger& ledger, std::function<bool()> const& stop) {
    LaneArray more(objective_.dimension(), draws_);
    for (int d = 0; d < draws_; ++d) mixture.draw(key_.with_index(static_cast<std::uint64_t>(theta_.width() + d)), more, d);
    std::vector<double> const density = log_density_in_blocks(objective_, more, ledger, stop);
    log_density_.insert(log_density_.end(), density.begin(), density.end());
    theta_ = beside(theta_, more);
    mixtures_.push_back(std::move(mixture));
  }

  LaneArray const& theta() const { return theta_; }
  bool all_failed() const {
    return std::ranges::none_of(log_density_, [](double each) { return std::isfinite(each); });
  }

  LeftOut weights() const {
    std::vector<double> mixed(log_density_.size(), -infinity);
    for (marginal::Mixture const& mixture : mixtures_) {
      std::vector<double> const one = mixture.log_density(mixture.log_terms(theta_));
      for (std::size_t d = 0; d < mixed.size(); ++d) {
        double const more = std::max(mixed[d], one[d]), less = std::min(mixed[d], one[d]);
        mixed[d] = more + elementary::log1p(elementary::exp(less - more));
      }
    }
    std::vector<double> ratios = log_density_;
    for (std::size_t d = 0; d < ratios.size(); ++d) ratios[d] -= mixed[d];
    return weighted(ratios, 1);
  }

 private:
  static LaneArray beside(LaneArray const& left, LaneArray const& right) {
    LaneArray out(right.rows(), left.width() + right.width());
    for (int i = 0; i < right.rows(); ++i) {
      if (left.width() > 0) std::ranges::copy(left.row(i), out.row(i).begin());
      std::ranges::copy(right.row(i), out.row(i).begin() + left.width());
    }
    return out;
  }

  Objective const& objective_;
  int draws_;
  StreamKey key_;
  LaneArray theta_;  // [P x draws so far]
  std::vector<double> log_density_;
  std::vector<marginal::Mixture> mixtures_;
};

/// As many draws of equal weight, each as often as its weight says.
LaneArray of_equal_weight(ConstLanes theta, LeftOut const& weights, int count) {
  LaneArray out(theta.rows(), count);
  int d = 0;
  double passed = elementary::exp(weights.log_weights.front());
  for (int k = 0; k < count; ++k) {
    while (d + 1 < theta.width() && (k + 0.5) / count > passed)
      passed += elementary::exp(weights.log_weights[static_cast<std::size_t>(++d)]);
    for (int i = 0; i < theta.rows(); ++i) out(i, k) = theta(i, d);
  }
  return out;
}

LaneArray last_of(LaneArray const& states, int count) {
  LaneArray out(states.rows(), count);
  ConstLanes const last = states.view().columns(states.width() - count, count);
  for (int i = 0; i < out.rows(); ++i) std::ranges::copy(last.row(i), out.row(i).begin());
  return out;
}

std::vector<Experiment> shortened(std::vector<ExperimentData> const& data, int experiment, int end) {
  std::vector<Experiment> experiments = experiments_of(data);
  std::vector<std::uint8_t>& scored = experiments[static_cast<std::size_t>(experiment)].scored;
  std::fill(scored.begin() + end, scored.end(), std::uint8_t{0});
  return experiments;
}

}  // namespace

std::optional<EarlierDraws> earlier_draws(FinishedFit& fit, int experiment, int end, int draws, int most, LaneArray& near) {
  if (fit.target.dimension() > most_parameters || fit.target.is_expensive()) return std::nullopt;
  auto const target =
      fit.likelihood.make_target(shortened(fit.data, experiment, end), fit.preparation.solver, fit.session.interruptible());
  auto const stop = [&] { return fit.session.interrupted(); };
  std::vector<Mode> modes = refit(*target, fit.objective_kind, fit.result.modes, fit.seed, fit.extra, stop);
  std::erase_if(modes, [](Mode const& each) { return !std::isfinite(each.log_density) || !std::isfinite(each.log_mass); });
  marginal::Mixture mixture = at_modes(modes);
  Objective const objective = make_objective(*target, fit.objective_kind, fit.seed, first_step);
  StreamKey const key{
      fit.seed, Purpose::start, 0,
      first_step + static_cast<std::uint64_t>(experiment + 1) * steps_of_record + static_cast<std::uint64_t>(end) * steps_of_rows};
  Rounds rounds(objective, draws, key);
  std::optional<LeftOut> best;  // k itself scatters by 0.1 to 0.2
  for (int round = 0; round < most_rounds && !mixture.empty() && !stop(); ++round) {
    rounds.add(std::move(mixture), fit.extra, stop);
    if (rounds.all_failed()) return std::nullopt;
    LeftOut const weights = rounds.weights();
    if (!best || weights.pareto_k < best->pareto_k) best = weights;
    if (weights.pareto_k <= good_k || near.width() == 0 || (round + 2) * draws > most) break;
    LaneArray const states = marginal::walk(
        objective, near, walk_steps, key.with_step(key.step + static_cast<std::uint64_t>(round * walk_steps)), fit.extra, stop);
    near = last_of(states, near.width());
    mixture = marginal::fit_mixture({}, states, fit.seed, stop);
  }
  if (!best) return std::nullopt;
  int const count = static_cast<int>(best->log_weights.size());
  EarlierDraws found{LaneArray(target->dimension(), count), std::move(*best)};
  ConstLanes const theta = rounds.theta().view().columns(0, count);
  target->constrain(theta, found.declared);
  if (near.width() > 0 && found.weights.pareto_k <= good_k) near = of_equal_weight(theta, found.weights, near.width());
  return found;
}

}  // namespace sysid
