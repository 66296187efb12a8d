// Chooses the solver that the result needs: by how far parameters move or, in a selection, by how far distances move.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/preflight/preflight.hpp"
#include "diagnostics/tolerance.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr double visible_shift = 0.05;  // of the distance that noise leaves; what a selection checks at its end
constexpr double gross_move = 0.1;      // of a response's sd: an nmse of 1, which a model is called excellent below

// By how many of its expected sds the worst parameter moves with the finer solver, to first order.
double move_of(LocalSlopes const& local, Eigen::Index level) {
  Eigen::VectorXd const change = local.sensitivity.others.col(level);
  if (!change.allFinite()) return std::numeric_limits<double>::infinity();
  Eigen::MatrixXd const slopes = local.sensitivity.slopes * local.spread.asDiagonal();
  SingularValues const svd = singular_values(slopes);
  Eigen::VectorXd const& s = svd.values;
  Eigen::VectorXd const gain = s.array() / (s.array().square() + 1);
  Eigen::VectorXd const move = svd.right * gain.asDiagonal() * svd.left.transpose() * change;
  return (move.cwiseAbs().array() / expect(local).shrinkage.array()).maxCoeff();
}

// The middle one; what is not finite comes last.
double middle(std::vector<double> values) {
  for (double& value : values)
    if (!std::isfinite(value)) value = std::numeric_limits<double>::infinity();
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

// What a selection compares are distances, and its thresholds end where noise or the best model leaves them: so the integrator is
// judged by what it does to those.
void describe_distances(Preflight const& preflight, PriorDraws const& prior, double response_move, double shift) {
  preflight.page.information->response_move = response_move;
  std::string const help = preflight.page.information->advised.empty() ? "use a finer solver"
                                                                       : fmt::format("use {}", preflight.page.information->advised);
  if (!(response_move <= gross_move))
    preflight.add(FindingCode::integration_step, Severity::warning, {},
                  fmt::format("with {} the solver changes the distances: {} moves the median response by {} of its sd",
                              preflight.what.solver.text(), preflight.what.solver.finer_words(),
                              std::isfinite(response_move) ? fmt::format("{:.2g} %", 100 * response_move) : "more than 100 %"),
                  help);
  else if (prior.noise.empty() && shift > visible_shift)
    preflight.add(
        FindingCode::integration_step, Severity::warning, {},
        fmt::format(
            "with {} the solver changes the distances: {} moves them by {:.2g} of the distance that the stated noise leaves",
            preflight.what.solver.text(), preflight.what.solver.finer_words(), shift),
        help);
}

}  // namespace

void describe_solvers(Preflight const& preflight, PriorDraws const& prior, std::vector<LocalResponse> const& responses) {
  std::vector<double> moves(preflight.solvers.size() - 1, 0.0), response_moves, shifts;
  if (moves.empty()) return;
  for (LocalResponse const& each : responses) {
    for (std::size_t level = 0; level < moves.size(); ++level)
      moves[level] = std::max(moves[level], move_of(each.slopes, static_cast<Eigen::Index>(level)));
    response_moves.push_back(each.moved);
    shifts.push_back(each.shift);
  }
  InformationPage& information = *preflight.page.information;
  information.refinement = preflight.what.solver.finer_words();
  if (!preflight.refines_solver()) information.taken = preflight.what.solver.text();
  for (std::size_t level = 0; level < moves.size(); ++level) {
    information.moves.emplace_back(preflight.solvers[level].text(), moves[level]);
    if (moves[level] > tolerable_move) continue;
    information.advised = preflight.solvers[level].text();
    break;
  }
  if (!preflight.what.refine_solver && !preflight.candidate() && moves.front() > tolerable_move)
    preflight.add(
        FindingCode::integration_step, Severity::warning, {},
        fmt::format("with {} the solver changes the result: with {} parameters move by up to {}", preflight.what.solver.text(),
                    preflight.what.solver.finer_words(), moves.front() > 5 ? "many sds" : fmt::format("{:.2g} sd", moves.front())),
        information.advised.empty()
            ? "remove its settings, which are then chosen automatically"
            : fmt::format("use {}, or remove its settings, which are then chosen automatically", information.advised));
  if (preflight.candidate()) describe_distances(preflight, prior, middle(std::move(response_moves)), middle(std::move(shifts)));
}

}  // namespace sysid
