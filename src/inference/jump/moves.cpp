// Proposals, densities, and the chance to be accepted.
#include "inference/jump/moves.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/numeric/not_finite.hpp"

namespace sysid::jump {
namespace {

std::size_t index_of(Place const& place) { return static_cast<std::size_t>(place.model); }

/// All of one model.
void evaluate_model(Model const& model, std::span<Place* const> places, Ledger& ledger) {
  Target const& target = *model.candidate->target;
  auto const count = static_cast<int>(places.size());
  LaneArray theta(target.dimension(), count);
  for (int w = 0; w < count; ++w)
    for (int p = 0; p < theta.rows(); ++p) theta(p, w) = places[static_cast<std::size_t>(w)]->theta[static_cast<std::size_t>(p)];
  std::vector<double> prior(places.size()), likelihood(places.size()), proposal(places.size(), 0.0);
  target.log_prior(theta, prior);
  target.log_likelihood(theta, likelihood, ledger);
  if (!model.mixture.empty()) proposal = model.mixture.log_density(model.mixture.log_terms(theta));
  double const constant = elementary::log(model.candidate->prior) + model.candidate->log_unit;
  for (std::size_t w = 0; w < places.size(); ++w) {
    double const density = prior[w] + likelihood[w] + constant;
    places[w]->log_density = std::isfinite(density) ? density : -infinity;
    places[w]->log_proposal = proposal[w];
  }
}

double chance(double log_ratio) { return log_ratio >= 0 ? 1 : log_ratio > -infinity ? elementary::exp(log_ratio) : 0; }

}  // namespace

void evaluate(std::span<Model const> models, std::span<Place* const> places, Ledger& ledger) {
  for (std::size_t m = 0; m < models.size(); ++m) {
    std::vector<Place*> own;
    for (Place* const place : places)
      if (index_of(*place) == m) own.push_back(place);
    if (!own.empty()) evaluate_model(models[m], own, ledger);
  }
}

Place propose(std::span<Model const> models, StreamKey key) {
  Stream stream(key.with_step(2 * key.step));
  Place place;
  place.model = static_cast<int>(stream.below(models.size()));
  marginal::Mixture const& mixture = models[index_of(place)].mixture;
  if (mixture.empty()) return place;
  LaneArray theta(models[index_of(place)].candidate->target->dimension(), 1);
  mixture.draw(key.with_step(2 * key.step + 1), theta, 0);
  for (int p = 0; p < theta.rows(); ++p) place.theta.push_back(theta(p, 0));
  return place;
}

double log_weight(std::span<Model const> models, Place const& place) {
  if (place.log_density == -infinity) return -infinity;
  return place.log_density - models[index_of(place)].bias - place.log_proposal;
}

double jump_acceptance(std::span<Model const> models, Place const& from, Place const& to) {
  double const there = log_weight(models, to);
  return there == -infinity ? 0 : chance(there - log_weight(models, from));
}

Place walk(std::span<Model const> models, Place const& from, StreamKey key) {
  constexpr double tenth = 0.1;
  Place place{from.model, from.theta, 0, 0};
  Model const& model = models[index_of(from)];
  if (model.mixture.empty()) return place;
  Stream stream(key.with_step(2 * key.step));
  auto const& parts = model.mixture.parts();
  Component const& shape = parts[stream.below(parts.size())].shape;
  double const length = model.scale * 2.38 / std::sqrt(static_cast<double>(from.theta.size()));
  double const shorter = stream.uniform() < tenth ? tenth : 1;
  Eigen::VectorXd const step = shorter * length * shape.move(stream, false);
  for (std::size_t p = 0; p < place.theta.size(); ++p) place.theta[p] += step(static_cast<Eigen::Index>(p));
  return place;
}

double walk_acceptance(Place const& from, Place const& to) {
  return to.log_density == -infinity ? 0 : chance(to.log_density - from.log_density);
}

}  // namespace sysid::jump
