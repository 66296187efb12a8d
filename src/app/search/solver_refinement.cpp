// Follows the modes on the stated solver and on finer ones; reports how far they moved and what did not converge.
#include "app/search/solver_refinement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "search/local_searches.hpp"
#include "search/mode_findings.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

bool spent(SolverSettings const& solver, Ledger const& ledger) {
  std::uint64_t count = 0;
  for (Failure const& each : ledger.failures()) count += each.kind == FailureClass::step_limit ? each.count : 0;
  return !solver.fixed_step() && 2 * count > ledger.failed();
}

// A finer solver that fails for want of steps says nothing of the result.
Finding not_converged(RefinedSolver const& refined, bool optimum, Ledger const& ledger) {
  if (!refined.moves.empty() && !std::isfinite(refined.moves.back()) && spent(refined.solver, ledger))
    return {FindingCode::step_not_settled,
            Severity::error,
            {},
            fmt::format("with {}, the simulation at the result needs more than {} steps between two samples",
                        refined.solver.finer_words(), refined.solver.steps),
            solver_advice(refined.solver, ledger)};
  if (refined.widths_alone)
    return {
        FindingCode::step_not_settled,
        optimum ? Severity::error : Severity::warning,
        {},
        fmt::format("with {} the modes stay where they are, but the curvature around them has not converged: {} are not reliable",
                    accuracy(refined.solver), optimum ? "the Laplace sds" : "the Laplace evidence and the weights of modes"),
        optimum ? "use mh, whose draws do not depend on the curvature" : "use the draws, which do not depend on the curvature"};
  if (!refined.given_up)
    return {FindingCode::step_not_settled,
            Severity::error,
            {},
            fmt::format("the result has not converged with {}", accuracy(refined.solver)),
            settling_advice(refined.solver)};
  return {FindingCode::step_not_settled,
          Severity::error,
          {},
          fmt::format("the result has not converged with {}: with {}, {}, almost as much as in the previous refinement, so still "
                      "finer settings were not tried",
                      accuracy(refined.solver), refined.solver.finer_words(), moved(refined.moves.back())),
          settling_advice(refined.solver)};
}

}  // namespace

void replace_mode_findings(Findings& findings, Findings const& of_modes) {
  remove_mode_findings(findings);
  findings.insert(findings.begin(), of_modes.begin(), of_modes.end());
}

bool refine_solver(Session& session, Task const& task, MakeTarget const& make, ObjectiveKind objective_kind,
                   SolverSettings const& stated, Preparation& preparation, RunContext& context) {
  std::erase_if(preparation.findings, [](Finding const& each) { return each.code == FindingCode::step_not_settled; });
  // Modes may need fewer steps than far corners of the prior.
  if (preparation.solver != stated)
    preparation.modes = refit(*make(stated), objective_kind, preparation.modes, context.seed, context.ledger, context.interrupted,
                              nullptr, context.journal);
  RefinedSolver refined = find_converged_solver(make, objective_kind, stated, std::move(preparation.modes), context);
  if (context.stop_requested()) return false;
  preparation.solver = refined.solver;
  preparation.modes = std::move(refined.modes);
  rank(objective_kind, preparation.modes);
  preparation.moves = refined.moves;
  // What looked like several may have been the solver's, and another may be the highest now.
  replace_mode_findings(preparation.findings, mode_findings(*make(refined.solver), objective_kind, preparation.modes));
  if (refined.solver != stated)
    session.notices << fmt::format("{}: the fit uses {}, because {} would be too coarse: with {}, {}\n", task.name,
                                   accuracy(refined.solver), accuracy(stated), stated.finer_words(),
                                   moved(preparation.moves.front()));
  if (!refined.converged)
    preparation.findings.push_back(not_converged(refined, objective_kind != ObjectiveKind::posterior, context.ledger));
  return true;
}

std::string settling_advice(SolverSettings const& solver) {
  bool const stiff = solver.row().stiff;
  return fmt::format("{}the model may {}be chaotic on this record: fit a shorter part of it",
                     stiff ? "" : fmt::format("if the model is stiff, fit it with `solver = {}`; ", stiff_solver().name),
                     stiff ? "" : "also ");
}

std::string solver_advice(SolverSettings const& solver, Ledger const& ledger) {
  std::string const other = solver.other_methods();
  if (spent(solver, ledger)) {
    std::string const more = fmt::format("allow more steps between two samples (`steps`, now {})", solver.steps);
    bool const few = solver.steps < SolverSettings{}.steps;
    return few || other.empty() ? more : fmt::format("{}, or use {}", more, other);
  }
  if (other.empty()) return {};
  return solver.fixed_step() ? "or let the solver choose its steps: " + other : "or use " + other;
}

Findings stiff_prior(SearchSolver const& search, bool exact) {
  if (!search.stiff() && search.too_fast())
    return {{FindingCode::stiff_prior,
             Severity::warning,
             {},
             fmt::format("{:.0f} % of the prior draws overflow with {}, and more with longer steps: for these draws the motion is "
                         "too fast for the steps, and the search ignores that part of the prior",
                         100 * search.failed, accuracy(search.solver)),
             fmt::format("fit with `solver = {}`, which {}, or narrow the priors if such fast motion is not intended",
                         exact ? exact_solver().name : adaptive_solver().name,
                         exact ? "is exact for these equations" : "takes as many steps as the motion needs")}};
  if (!search.stiff()) return {};
  return {{FindingCode::stiff_prior,
           Severity::warning,
           {},
           fmt::format("{:.0f} % of the prior draws overflow even with {}; {} of these were simulated with {}, {} of them without "
                       "failure: the model is stiff for these draws, and the search ignores that part of the prior",
                       100 * search.failed, accuracy(search.solver), search.tried, stiff_solver().name, search.followed),
           fmt::format("fit with `solver = {}`{}, or narrow the priors if such fast motion is not intended",
                       exact ? exact_solver().name : stiff_solver().name, exact ? ", which is exact for these equations" : "")}};
}

}  // namespace sysid
