// Chooses the solver that the result needs: by how far parameters move or, in a selection, by how far distances move. What draws of
// the prior suggest is confirmed where the data are: at a mode found from the nearest of them, found again with a finer solver.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "app/preflight/check_file.hpp"
#include "app/preflight/preflight.hpp"
#include "diagnostics/tolerance/tolerance_check.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/local_searches.hpp"
#include "search/refit.hpp"

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
  std::string const help = preflight.page.information->advised.empty()
                               ? "use a finer solver"
                               : fmt::format("use `solver = {}`", preflight.page.information->advised);
  Severity const severity = preflight.what.solver.as_model ? Severity::note : Severity::warning;
  if (!(response_move <= gross_move))
    preflight.add(FindingCode::integration_step, severity, {},
                  fmt::format("the distances depend on the accuracy of {}: with {} the median response changes by {} of its sd",
                              preflight.what.solver.text(), preflight.what.solver.finer_words(),
                              std::isfinite(response_move) ? fmt::format("{:.2g} %", 100 * response_move) : "more than 100 %"),
                  help);
  else if (prior.noise.empty() && shift > visible_shift)
    preflight.add(
        FindingCode::integration_step, severity, {},
        fmt::format(
            "the distances depend on the accuracy of {}: with {} they change by {:.2g} times the distance due to the stated noise",
            preflight.what.solver.text(), preflight.what.solver.finer_words(), shift),
        help);
}

constexpr int most_starts = 48, fewest_starts = 8;  // of the short search
constexpr double affordable = 5e9;  // operations of the equations at the steps of all its trajectories: some seconds

// How many searches by finite differences may start, beside their widths and the same again with half the step; 0: too few.
int affordable_starts(Preflight const& preflight) {
  double const p = preflight.space->dimension(), round = 2 * p + 5;
  double const solves = affordable / (preflight.step_work * preflight.solver_work()) - 3 * (3 * (1 + 2 * p * p) + 20 * round);
  double const starts = solves / (10 * round);  // most are left early
  return starts < fewest_starts ? 0 : static_cast<int>(std::min(starts, static_cast<double>(most_starts)));
}

// Local searches with the stated solver from the draws of highest likelihood, followed to the finer one; nothing where that would
// take long, or where no two of the searches end in the same mode: then it need not be the one of the fit.
std::optional<SolverCheck> found_from_draws(Preflight const& preflight, PriorDraws const& prior) {
  auto const starts = static_cast<std::size_t>(affordable_starts(preflight));
  if (starts == 0) return std::nullopt;
  std::vector<double> const& density = prior.simulations.density;
  std::vector<int> order;
  for (int w = 0; w < prior.theta.width(); ++w)
    if (std::isfinite(density[static_cast<std::size_t>(w)])) order.push_back(w);
  std::stable_sort(order.begin(), order.end(),
                   [&](int a, int b) { return density[static_cast<std::size_t>(a)] > density[static_cast<std::size_t>(b)]; });
  if (order.size() > starts) order.resize(starts);
  LaneArray theta(prior.theta.rows(), static_cast<int>(order.size()));
  for (int p = 0; p < theta.rows(); ++p)
    for (int w = 0; w < theta.width(); ++w) theta(p, w) = prior.theta(p, order[static_cast<std::size_t>(w)]);
  auto const target_of = [&](SolverSettings const& solver) {
    return make_fit_target(preflight.session, preflight.what, preflight.compiled, preflight.space, preflight.experiments, solver,
                           preflight.session.abandonable());
  };
  std::uint64_t const seed = preflight.session.options.seed.value_or(preflight.what.seed.value_or(1));
  Ledger ignored;
  std::vector<Mode> const modes = modes_from(*target_of(preflight.what.solver), ObjectiveKind::posterior, theta,
                                             -std::numeric_limits<double>::infinity(), seed, ignored)
                                      .modes;
  if (modes.empty() || modes.front().hits < 2) return std::nullopt;
  return check_modes(*target_of(preflight.what.solver.finer()), ObjectiveKind::posterior, {modes.front()}, seed, ignored);
}

// The draws suggest that the stated solver is too coarse.
void confirm(Preflight const& preflight, PriorDraws const& prior, double suggested) {
  SolverSettings const& solver = preflight.what.solver;
  InformationPage& information = *preflight.page.information;
  std::optional<SolverCheck> const found = found_from_draws(preflight, prior);
  if (!found) {
    std::string const sds = suggested > 5 ? "more than 5 sds" : fmt::format("up to {:.2g} sd", suggested);
    preflight.add(
        FindingCode::integration_step, Severity::note, {},
        fmt::format("{} may be too inaccurate: at draws of the prior, estimates would change by {} with {}, but no mode was found "
                    "that confirms this",
                    solver.text(), sds, solver.finer_words()),
        solver.as_model ? "nothing, if the solver is meant to be part of the model" : "nothing now: the fit checks its own result");
    return;
  }
  if (found->outcome != SolverCheck::Outcome::fails) information.found_move = found->largest();
  for (Finding finding : tolerance_findings(*found, solver, false)) {
    if (finding.severity == Severity::error) finding.severity = Severity::warning;
    preflight.page.findings.push_back(std::move(finding));
  }
}

// What is sufficient at the draws that were examined need not be at the others, of which the findings tell.
void judge_by_prior(Preflight const& preflight) {
  constexpr std::size_t slow = 4;  // a method of order 4 gains a factor of 16 by each halving, where nothing jumps
  InformationPage& information = *preflight.page.information;
  Findings const& found = preflight.page.findings;
  if (std::any_of(found.begin(), found.end(), [](Finding const& each) { return each.code == FindingCode::stiff_prior; })) {
    information.advised = stiff_solver().name;
    information.prior_overflows = true;
  } else if (!preflight.sticking.empty() && information.moves.size() > slow) {
    auto const& [solver, move] = information.moves[slow - 1];
    information.advised.clear();
    preflight.add(FindingCode::integration_step, preflight.what.solver.as_model ? Severity::note : Severity::warning, {},
                  fmt::format("with {}, estimates still differ by {} sd from those with {}: the equations are discontinuous where "
                              "a velocity changes its sign",
                              information.refinement, move > 5 ? "many" : fmt::format("{:.2g}", move), solver),
                  preflight.sticking);
  }
}

}  // namespace

Findings check_method(Session const& session, FitTask const& what) {
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  if (!model.integrated() || !what.solver.row().implicit) return {};
  if (model.implicit || !model.invariants.empty() || !model.unknowns.empty()) return {};
  return {{FindingCode::slower_solver,
           Severity::note,
           {},
           fmt::format("{} is a solver for implicit equations, but the equations of `{}` give their highest derivatives explicitly",
                       what.solver.method, model.name),
           fmt::format("`solver = {}` is faster at the same tolerance; {} and {} are much faster unless the model is stiff",
                       stiff_solver().name, SolverSettings{}.method, adaptive_solver().name)}};
}

void describe_solvers(Preflight const& preflight, PriorDraws const& prior, std::vector<LocalResponse> const& responses) {
  InformationPage& information = *preflight.page.information;
  if (preflight.exact_steps) information.exact = exact_solver().name;
  std::vector<double> moves(preflight.solvers.size() - 1, 0.0), response_moves, shifts;
  if (preflight.what.solver.row().exact) information.taken = preflight.what.solver.text();
  if (moves.empty()) return;
  for (LocalResponse const& each : responses) {
    for (std::size_t level = 0; level < moves.size(); ++level)
      moves[level] = std::max(moves[level], move_of(each.slopes, static_cast<Eigen::Index>(level)));
    response_moves.push_back(each.moved);
    shifts.push_back(each.shift);
  }
  information.refinement = preflight.what.solver.finer_words();
  if (!preflight.refines_solver()) information.taken = preflight.what.solver.text();
  for (std::size_t level = 0; level < moves.size(); ++level) {
    information.moves.emplace_back(preflight.solvers[level].text(), moves[level]);
    if (moves[level] > tolerable_move) continue;
    information.advised = preflight.solvers[level].text();
    break;
  }
  judge_by_prior(preflight);
  if (!preflight.what.refine_solver && !preflight.candidate() && moves.front() > tolerable_move)
    confirm(preflight, prior, moves.front());
  if (preflight.candidate()) describe_distances(preflight, prior, middle(std::move(response_moves)), middle(std::move(shifts)));
}

}  // namespace sysid
