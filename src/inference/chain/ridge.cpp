// Steps along a ridge and back onto it.
#include "inference/chain/ridge.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"

namespace sysid::metropolis {
namespace {

constexpr int most_places = 300;      // to a side
constexpr double negligible = -8;     // nats below the largest mass
constexpr double along = 0.7;         // sd of a component along the ridge, in steps
constexpr int most_newton_steps = 8;  // back onto the ridge
constexpr double settled = 0.01;      // nats that a Newton step promises at the top
constexpr double flattest = 1e-2;     // curvature of what nothing resists, per prior width squared: ten prior widths
/// Of a mixture on trial, and the iteration that names their numbers, which no chain reaches.
constexpr std::uint64_t trial_draws = 512, trial_step = std::uint64_t{1} << 40;
constexpr double parts_of_step[] = {1, 0.5, 0.2, 0.05};

/// A place on the ridge, in prior widths.
struct Place {
  Eigen::VectorXd x, tangent;              // |tangent| = 1
  Eigen::MatrixXd inverse;                 // A
  double log_density = 0, log_across = 0;  // log of the density, and of (det A / t'A t)^(1/2)
  double step = 0;                         // to the next place outwards
};

class Tracer {
 public:
  Tracer(Objective const& objective, Ledger& ledger) : objective_(objective), ledger_(ledger) {}

  /// The highest place in the plane through x across `tangent`; nothing where the density is not finite.
  std::optional<Place> top(Eigen::VectorXd x, Eigen::VectorXd const& tangent) {
    Place place;
    place.log_density = log_densities({x}).front();
    if (!std::isfinite(place.log_density)) return std::nullopt;
    for (int i = 0; i < most_newton_steps; ++i) {
      auto const [gradient, curvature] = slope(x);
      auto const factor = cholesky(curvature);
      if (!factor) return std::nullopt;
      place.inverse = solve_cholesky(*factor, Eigen::MatrixXd::Identity(x.size(), x.size()));
      if (!place.inverse.allFinite()) return std::nullopt;
      Eigen::VectorXd const along_tangent = place.inverse * tangent, whole = place.inverse * gradient;
      Eigen::VectorXd const step = whole - along_tangent * (tangent.dot(whole) / tangent.dot(along_tangent));
      if (step.dot(gradient) < 2 * settled || i + 1 == most_newton_steps) break;
      std::vector<Eigen::VectorXd> trials;
      for (double const part : parts_of_step) trials.push_back(x + part * step);
      std::vector<double> const reached = log_densities(trials);
      auto const best = std::max_element(reached.begin(), reached.end());
      if (!(*best > place.log_density)) break;
      place.log_density = *best;
      x = trials[static_cast<std::size_t>(best - reached.begin())];
    }
    place.x = x;
    place.tangent = (place.inverse * tangent).normalized();
    if (place.tangent.dot(tangent) < 0) place.tangent = -place.tangent;
    double log_volume = 0;
    auto const factor = cholesky(place.inverse);
    if (!factor) return std::nullopt;
    for (Eigen::Index p = 0; p < x.size(); ++p) log_volume += elementary::log((*factor)(p, p));
    place.log_across = log_volume - elementary::log(place.tangent.dot(place.inverse * place.tangent)) / 2;
    if (!std::isfinite(place.log_across)) return std::nullopt;
    return place;
  }

  struct Side {
    std::vector<Place> places;
    bool complete = false;  // the end of the ridge is reached
  };
  /// Places outwards from `from`, itself left out, whose step is set. `highest`: of density times width across, so far.
  Side side(Place& from, Eigen::VectorXd const& direction, double& highest) {
    Side side;
    std::vector<Place>& places = side.places;
    Place* last = &from;
    Eigen::VectorXd tangent = direction;
    double step = length(from) / 2;
    places.reserve(most_places);
    while (static_cast<int>(places.size()) < most_places) {
      std::optional<Place> next;
      double off = 0;  // sds across the ridge by which the tangent missed it
      for (int tries = 0; tries < 6; ++tries, step *= std::clamp(1 / std::sqrt(off), 0.2, 0.7)) {
        Eigen::VectorXd const ahead = last->x + step * tangent;
        next = top(ahead, tangent);
        off = 25;
        if (!next) continue;
        Eigen::VectorXd const missed = next->x - ahead;
        off = std::sqrt(std::max(0.0, missed.dot(solve_symmetric(next->inverse, missed))));
        if (off <= 1.5) break;
        next.reset();
      }
      if (!next) break;
      last->step = last == &from ? std::max(last->step, step) : step;
      next->step = step;
      places.push_back(std::move(*next));
      last = &places.back();
      tangent = last->tangent;
      double const mass = last->log_density + last->log_across;
      highest = std::max(highest, mass);
      side.complete = mass < highest + negligible;
      if (side.complete) break;
      step = std::min(step * std::clamp(1 / std::sqrt(std::max(off, 1e-3)), 0.5, 2.0), 0.7 * length(*last));
    }
    return side;
  }

  /// Of the ridge as its curvature has it at a place, in prior widths.
  static double length(Place const& place) { return std::sqrt(place.tangent.dot(place.inverse * place.tangent)); }

 private:
  std::vector<double> log_densities(std::vector<Eigen::VectorXd> points) {
    for (Eigen::VectorXd& point : points) point = point.cwiseProduct(objective_.scale);
    return objective_.log_density(to_lanes(points), ledger_);
  }
  std::pair<Eigen::VectorXd, Eigen::MatrixXd> slope(Eigen::VectorXd const& x) {
    auto [gradient, curvature] = slope_at(objective_, x.cwiseProduct(objective_.scale), ledger_);
    Eigen::VectorXd const& s = objective_.scale;
    curvature = s.asDiagonal() * curvature * s.asDiagonal();
    curvature.diagonal().array() += flattest;
    return {gradient.cwiseProduct(s), curvature};
  }

  Objective const& objective_;
  Ledger& ledger_;
};

}  // namespace

RidgeRow along_ridge(Objective const& objective, Mode const& mode, Ledger& ledger) {
  Eigen::VectorXd const& s = objective.scale;
  Eigen::MatrixXd const covariance = s.cwiseInverse().asDiagonal() * covariance_of(mode) * s.cwiseInverse().asDiagonal();
  SymmetricEigen const axes = symmetric_eigen(covariance);
  RidgeRow row{{{1, theta_of(mode), covariance_of(mode)}}};
  Tracer tracer(objective, ledger);
  std::optional<Place> centre = tracer.top(theta_of(mode).cwiseQuotient(s), axes.vectors.rightCols(1));
  if (!centre) return row;
  double highest = centre->log_density + centre->log_across;
  auto [places, forward] = tracer.side(*centre, centre->tangent, highest);
  auto [others, backward] = tracer.side(*centre, -centre->tangent, highest);
  std::ranges::move(others, std::back_inserter(places));
  if (places.empty()) return row;
  places.push_back(std::move(*centre));
  row = {{}, forward && backward};
  for (Place const& place : places) {
    Eigen::VectorXd const follows = place.inverse * place.tangent;
    double const square = place.tangent.dot(follows), sd = along * place.step;
    Eigen::MatrixXd const local = place.inverse + follows * follows.transpose() * ((sd * sd / square - 1) / square);
    double const weight = elementary::exp(std::max(-30.0, place.log_density + place.log_across - highest)) * place.step;
    if (weight > 0) row.components.push_back({weight, place.x.cwiseProduct(s), s.asDiagonal() * local * s.asDiagonal()});
  }
  return row;
}

double worth_of_draws(Objective const& objective, Independence const& mixture, std::uint64_t seed, Ledger& ledger) {
  std::vector<StreamKey> keys;
  for (std::uint64_t n = 0; n < trial_draws; ++n) keys.push_back({seed, Purpose::proposal, n, trial_step});
  LaneArray theta(mixture.dimension(), static_cast<int>(keys.size()));
  mixture.draw(keys, theta);
  std::vector<double> log_q(keys.size());
  mixture.log_density(theta, log_q);
  std::vector<double> log_weight = objective.log_density(theta, ledger);
  for (std::size_t n = 0; n < keys.size(); ++n) log_weight[n] -= log_q[n];
  double const highest = *std::max_element(log_weight.begin(), log_weight.end());
  if (!std::isfinite(highest)) return 0;
  for (double& each : log_weight) each = elementary::exp(each - highest);
  return effective_number(log_weight) / static_cast<double>(keys.size());
}

}  // namespace sysid::metropolis
