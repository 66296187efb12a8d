// Importance sampling on the sampler's coordinates.
#include "app/fit/earlier_posterior.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/laplace.hpp"
#include "search/objective.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr int most_parameters = 40;
constexpr int most_rounds = 3;
constexpr double freedom = 5;
constexpr std::uint64_t first_step = 8'000'000;  // of Purpose::start

/// Student's t of one place and shape.
struct Component {
  double share;
  Eigen::VectorXd centre;
  Eigen::MatrixXd root;

  /// Without the constant that all have.
  double log_density(Eigen::VectorXd const& u) const {
    Eigen::VectorXd z = u - centre;
    double log_volume = 0;
    for (Eigen::Index i = 0; i < z.size(); ++i) {
      for (Eigen::Index j = 0; j < i; ++j) z(i) -= root(i, j) * z(j);
      z(i) /= root(i, i);
      log_volume += elementary::log(root(i, i));
    }
    return elementary::log(share) - log_volume -
           0.5 * (freedom + static_cast<double>(z.size())) * elementary::log1p(z.squaredNorm() / freedom);
  }
};

std::vector<Component> at_modes(std::vector<Mode> const& modes) {
  std::vector<Component> components;
  double heaviest = -infinity, sum = 0;
  for (Mode const& mode : modes) heaviest = std::max(heaviest, mode.log_mass);
  for (Mode const& mode : modes) {
    double const share = elementary::exp(mode.log_mass - heaviest);
    if (!(share > 1e-3)) continue;
    components.push_back({share, theta_of(mode), cholesky_or_diagonal(covariance_of(mode))});
    sum += share;
  }
  for (Component& each : components) each.share /= sum;
  std::erase_if(components, [](Component const& each) { return !(each.root.diagonal().array() > 0).all(); });
  return components;
}

std::vector<Eigen::VectorXd> draws_of(std::vector<Component> const& components, int draws, StreamKey key) {
  std::vector<Eigen::VectorXd> places;
  std::size_t which = 0;
  double passed = components.front().share;
  for (int d = 0; d < draws; ++d) {
    while (which + 1 < components.size() && (d + 0.5) / draws > passed) passed += components[++which].share;
    Stream stream(key.with_index(static_cast<std::uint64_t>(d)));
    Eigen::VectorXd z(components[which].centre.size());
    for (double& each : z) each = stream.normal();
    double square = 0;
    for (int i = 0; i < static_cast<int>(freedom); ++i) {
      double const each = stream.normal();
      square += each * each;
    }
    places.push_back(components[which].centre + std::sqrt(freedom / square) * (components[which].root * z));
  }
  return places;
}

double log_density(std::vector<Component> const& components, Eigen::VectorXd const& u) {
  double sum = 0, largest = -infinity;
  for (Component const& each : components) largest = std::max(largest, each.log_density(u));
  for (Component const& each : components) sum += elementary::exp(each.log_density(u) - largest);
  return largest + elementary::log(sum);
}

/// Where the weighted draws are; something of the first shape is left, since a few span no volume.
Component adapted(std::vector<Eigen::VectorXd> const& places, LeftOut const& weights, Component const& first) {
  Component out{1, Eigen::VectorXd::Zero(first.centre.size()), {}};
  auto const weight = [&](std::size_t d) { return elementary::exp(weights.log_weights[d]); };
  for (std::size_t d = 0; d < places.size(); ++d) out.centre += weight(d) * places[d];
  Eigen::MatrixXd covariance = 0.01 * first.root * first.root.transpose();
  for (std::size_t d = 0; d < places.size(); ++d)
    covariance += weight(d) * (places[d] - out.centre) * (places[d] - out.centre).transpose();
  out.root = cholesky_or_diagonal(covariance);
  return out;
}

std::vector<Experiment> shortened(std::vector<ExperimentData> const& data, int experiment, int end) {
  std::vector<Experiment> experiments = experiments_of(data);
  std::vector<std::uint8_t>& scored = experiments[static_cast<std::size_t>(experiment)].scored;
  std::fill(scored.begin() + end, scored.end(), std::uint8_t{0});
  return experiments;
}

}  // namespace

std::optional<EarlierDraws> earlier_draws(FinishedFit& fit, int experiment, int end, int draws) {
  if (fit.target.dimension() > most_parameters || fit.target.is_expensive()) return std::nullopt;
  auto const target =
      fit.likelihood.make_target(shortened(fit.data, experiment, end), fit.preparation.solver, fit.session.interruptible());
  auto const stop = [&] { return fit.session.interrupted(); };
  std::vector<Mode> modes = refit(*target, fit.objective_kind, fit.result.modes, fit.seed, fit.extra, stop);
  std::erase_if(modes, [](Mode const& each) { return !std::isfinite(each.log_density) || !std::isfinite(each.log_mass); });
  std::vector<Component> components = at_modes(modes);
  if (components.empty()) return std::nullopt;
  Objective const objective = make_objective(*target, fit.objective_kind, fit.seed, first_step);
  std::optional<EarlierDraws> found;
  for (int round = 0; round < most_rounds && !stop(); ++round) {
    auto const step = first_step + 1 + static_cast<std::uint64_t>(most_rounds * end + round);
    std::vector<Eigen::VectorXd> const places =
        draws_of(components, draws, {fit.seed, Purpose::start, static_cast<std::uint64_t>(experiment), step});
    std::vector<double> ratios = log_density_in_blocks(objective, to_lanes(places), fit.extra, stop);
    if (std::ranges::none_of(ratios, [](double each) { return std::isfinite(each); })) return std::nullopt;
    for (std::size_t d = 0; d < places.size(); ++d) ratios[d] -= log_density(components, places[d]);
    found = EarlierDraws{LaneArray(target->dimension(), draws), weighted(ratios, 1)};
    target->constrain(to_lanes(places), found->declared);
    if (found->weights.pareto_k <= largest_k) break;
    components = {adapted(places, found->weights, components.front())};
    if (!(components.front().root.diagonal().array() > 0).all()) break;
  }
  return found;
}

}  // namespace sysid
