// A few Levenberg-Marquardt rounds and a Laplace approximation per mode.
#include "search/refit.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/numeric/not_finite.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/search_step.hpp"
#include "search/settle.hpp"

namespace sysid {
namespace {

constexpr int rounds = 20, evaluations = 60;  // rounds of a density that vanishes at bounds, too
constexpr std::uint64_t refit_step = 2;

}  // namespace

std::vector<Mode> refit(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                        Ledger& ledger, std::function<bool()> const& stop, std::vector<double>* gains, Journal* journal) {
  Objective const objective = make_objective(target, objective_kind, seed, refit_step);
  std::vector<Climber> climbers;
  std::vector<Eigen::VectorXd> points;
  for (Mode const& mode : modes) points.push_back(theta_of(mode));
  if (points.empty()) return {};
  std::vector<double> const density = log_density_in_blocks(objective, to_lanes(points), ledger, stop, journal);
  for (std::size_t m = 0; m < modes.size(); ++m) climbers.push_back(climber_at(points[m], density[m]));
  climb(objective, climbers, target.climbs_by_gradient() || objective_kind == ObjectiveKind::posterior ? evaluations : rounds,
        ledger, stop, journal);
  settle(objective, climbers, settling_rounds, ledger, stop, journal);
  std::vector<Mode> result;
  for (std::size_t m = 0; m < modes.size(); ++m) {
    if (stop && stop()) {
      result.push_back(modes[m]);
      continue;
    }
    if (!std::isfinite(climbers[m].log_density)) {
      result.push_back(modes[m]);
      result.back().log_density = -std::numeric_limits<double>::infinity();
      continue;
    }
    Eigen::MatrixXd const guess = climbers[m].curvature.size() > 0
                                      ? climbers[m].curvature
                                      : Eigen::MatrixXd(objective.scale.cwiseAbs2().cwiseInverse().asDiagonal());
    result.push_back(kept_mode(journal, ledger, stop, [&] { return laplace_mode(objective, climbers[m].theta, guess, ledger); }));
    result.back().share = modes[m].share;
    result.back().hits = modes[m].hits;
    result.back().stalled = climbers[m].stalled;
  }
  for (std::size_t m = 0; gains != nullptr && m < modes.size(); ++m) gains->push_back(result[m].log_density - density[m]);
  return result;
}

bool at_bound(ParameterInfo const& parameter, double declared, double sd) {
  double const width = parameter.upper - parameter.lower;
  if (!std::isfinite(width)) {
    double const distance = std::min(declared - parameter.lower, parameter.upper - declared);
    return distance <= 0 || sd > 10 * distance;
  }
  // Logarithmic coordinates end at the lower bound relative to it, not to the width.
  double const unit = parameter.lower > 0 ? std::min(width, parameter.lower) : width;
  return declared - parameter.lower < 1e-3 * unit || parameter.upper - declared < 1e-3 * width;
}

namespace {

bool flat_in(Mode const& mode, std::size_t parameter) {
  for (std::size_t at = parameter; at < mode.flat.size(); at += mode.declared.size())
    if (mode.flat[at] != 0) return true;
  return false;
}

/// Sds that a flat direction has made the prior's hide what was gained across it: that is the move of what moves most.
void show_hidden(std::vector<Move>& moves, double allowed) {
  auto const most = std::max_element(moves.begin(), moves.end(), [](Move const& a, Move const& b) { return a.value < b.value; });
  if (most != moves.end() && allowed > 1 && most->value < 0.2 * allowed) most->value = allowed;
}

}  // namespace

std::vector<Move> moves_between(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain) {
  std::vector<Move> moves;
  bool const finite = std::isfinite(before.log_density) && std::isfinite(after.log_density);
  double const allowed = std::sqrt(2 * std::max(0.0, gain));  // sds
  for (std::size_t p = 0; p < before.declared.size(); ++p) {
    auto const parameter = static_cast<int>(p);
    if (!finite) {
      moves.push_back({parameter, infinity, infinity});
      continue;
    }
    bool const was = at_bound(parameters[p], before.declared[p], before.sd[p]),
               is = at_bound(parameters[p], after.declared[p], after.sd[p]);
    bool const was_flat = flat_in(before, p), is_flat = flat_in(after, p);
    bool const before_measures = before.sd[p] > 0 && !was && (!was_flat || is_flat);
    double const sd = before_measures ? before.sd[p] : after.sd[p];
    if ((was && is) || !(sd > 0)) continue;
    Move move{parameter, std::abs(after.declared[p] - before.declared[p]) / sd, std::abs(after.sd[p] - before.sd[p]) / sd};
    bool const wrong = move.value > 2 * allowed;
    if (wrong) move.value = allowed;
    if (wrong || was || is || was_flat || is_flat) move.width = 0;
    moves.push_back(move);
  }
  if (finite && !(before.flat.empty() && after.flat.empty())) show_hidden(moves, allowed);
  return moves;
}

Move largest_move(std::span<ParameterInfo const> parameters, Mode const& before, Mode const& after, double gain) {
  Move most;
  for (Move const& move : moves_between(parameters, before, after, gain))
    if (move.size() > most.size()) most = move;
  return most;
}

}  // namespace sysid
