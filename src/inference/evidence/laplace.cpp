// Laplace's approximation, mode by mode, and an estimate of its error.
#include "inference/evidence/laplace.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/text/without_index.hpp"
#include "inference/evidence/weighted_draws.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"

namespace sysid {
namespace {

constexpr std::uint64_t evidence_step = 4;  // of Purpose::start
constexpr double last = 27.6;               // of a coordinate that ends at infinity: 1e-12 of the interval from its bound

/// Parameters that take part in flat directions; an unknown function stands for all its coefficients.
std::vector<std::string> names_along(Target const& target, std::vector<double> const& flat) {
  auto const parameters = static_cast<std::size_t>(target.dimension());
  std::vector<std::string> names;
  for (std::size_t p = 0; p < parameters; ++p)
    for (std::size_t at = p; at < flat.size(); at += parameters) {
      ParameterInfo const& parameter = target.parameters()[p];
      std::string const name = parameter.coefficient ? without_index(parameter.name) : parameter.name;
      if (flat[at] != 0 && (names.empty() || names.back() != name)) names.push_back(name);
    }
  return names;
}

/// Parameters that a mode has at the end of their coordinate, where nothing more of it bends.
std::vector<std::string> names_at_end(Objective const& objective, Mode const& mode) {
  std::vector<std::string> names;
  for (Eigen::Index p = 0; p < objective.scale.size(); ++p) {
    double const u = mode.theta[static_cast<std::size_t>(p)], near = 1e-6 * objective.scale(p);
    if (u <= objective.low(p) + near || u >= objective.high(p) - near)
      names.push_back(objective.target.parameters()[static_cast<std::size_t>(p)].name);
  }
  return names;
}

/// A search ends where no draw of the prior lies, but a posterior may.
void follow_further(Objective& objective, Mode& mode, Ledger& ledger, std::function<bool()> const& stop) {
  for (Eigen::Index p = 0; p < objective.scale.size(); ++p) {
    if (std::isfinite(objective.low(p))) objective.low(p) = std::min(objective.low(p), -last);
    if (std::isfinite(objective.high(p))) objective.high(p) = std::max(objective.high(p), last);
  }
  constexpr int rounds = 60;
  std::vector<Climber> climber = {climber_at(theta_of(mode), mode.log_density)};
  climb(objective, climber, rounds, ledger, stop);
  int const hits = mode.hits;
  Eigen::MatrixXd const guess = climber.front().curvature.size() > 0 ? climber.front().curvature : inverse(covariance_of(mode));
  mode = laplace_mode(objective, climber.front().theta, guess, ledger);
  mode.hits = hits;
}

SampledEvidence by_draws(double laplace, WeightedDraws const& draws) {
  constexpr double precise = 0.25;  // nats
  if (draws.draws == 0) return {};
  bool const known = draws.tell() && draws.error < precise;
  return {known ? SampledEvidence::State::known : SampledEvidence::State::unknown, known ? draws.log_evidence - laplace : 0,
          known ? draws.error : 0, draws.effective, static_cast<std::uint64_t>(draws.draws)};
}

/// log of the integral along each axis of a mode over that of the normal density, summed.
double along_axes(Objective const& objective, Mode const& mode, Ledger& ledger) {
  struct Node {
    double at, weight;
  };
  // Five points for the weight of the standard normal, the one at its centre apart: Abramowitz and Stegun 1964, table 25.10.
  constexpr double at_centre = 8.0 / 15;
  constexpr std::array<Node, 4> nodes = {{{1.3556261799742659, 0.22207592200561265},
                                          {-1.3556261799742659, 0.22207592200561265},
                                          {2.8569700138728056, 0.011257411327720689},
                                          {-2.8569700138728056, 0.011257411327720689}}};
  Eigen::MatrixXd const covariance = covariance_of(mode);
  Eigen::VectorXd const sd = covariance.diagonal().cwiseSqrt(), per_sd = sd.cwiseInverse();
  auto const [values, vectors] = symmetric_eigen(per_sd.asDiagonal() * covariance * per_sd.asDiagonal());
  Eigen::VectorXd const centre = theta_of(mode);
  std::vector<Eigen::VectorXd> points;
  for (Eigen::Index k = 0; k < centre.size(); ++k) {
    Eigen::VectorXd const axis = std::sqrt(std::max(0.0, values(k))) * sd.cwiseProduct(vectors.col(k));
    for (Node const& node : nodes) points.push_back(centre + node.at * axis);
  }
  std::vector<double> const density = log_density_in_blocks(objective, to_lanes(points), ledger);
  double sum = 0;
  for (std::size_t k = 0; k < density.size() / nodes.size(); ++k) {
    double ratio = at_centre;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      ratio +=
          nodes[i].weight * elementary::exp(density[k * nodes.size() + i] - mode.log_density + 0.5 * nodes[i].at * nodes[i].at);
    sum += elementary::log(ratio);
  }
  return sum;
}

}  // namespace

Evidence laplace_evidence(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                          Ledger& ledger, std::function<bool()> const& stop, bool weighted) {
  if (objective_kind == ObjectiveKind::likelihood)
    return {{}, "only the likelihood was maximised, but an evidence is an average over the prior", 0, 0, true};
  if (modes.empty() || target.dimension() == 0) return {{}, "no mode was searched for", 0, 0};
  std::vector<Mode> found = sampled_modes(target, objective_kind, modes, seed, ledger, stop);
  if (found.empty()) return {{}, "no mode of the posterior has a finite density", 0, 0};
  auto const best =
      std::max_element(found.begin(), found.end(), [](Mode const& a, Mode const& b) { return a.log_mass < b.log_mass; });
  Objective objective = make_objective(target, ObjectiveKind::posterior, seed, evidence_step);
  if (!names_at_end(objective, *best).empty()) follow_further(objective, *best, ledger, stop);
  if (auto const names = names_at_end(objective, *best); !names.empty())
    return {{}, fmt::format("the mode lies at a bound of {}", fmt::join(names, ", ")), 0, 0};
  if (!best->flat.empty())
    return {{}, fmt::format("the posterior is flat at its mode in {}", fmt::join(names_along(target, best->flat), ", ")), 0, 0};
  if (!std::isfinite(best->log_mass)) return {{}, "the curvature at the mode is singular", 0, 0};
  double sum = 0;
  for (Mode const& mode : found) sum += elementary::exp(mode.log_mass - best->log_mass);
  Evidence evidence{best->log_mass + elementary::log(sum), "", along_axes(objective, *best, ledger),
                    static_cast<int>(found.size())};
  if (weighted) evidence.sampled = by_draws(*evidence.log_evidence, weighted_draws(target, found, seed, ledger, stop));
  return evidence;
}

}  // namespace sysid
