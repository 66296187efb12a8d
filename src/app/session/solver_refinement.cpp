// Follows the modes on the stated solver and on finer ones; reports how far they moved and what did not converge.
#include "app/session/solver_refinement.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "search/local_searches.hpp"
#include "search/refit.hpp"
#include "search/search.hpp"

namespace sysid {
namespace {

Finding not_converged(RefinedSolver const& refined) {
  std::string const help = "if the model is stiff, fit it with `solver = cvode`; it may also be chaotic on this record";
  if (!refined.given_up)
    return {FindingCode::step_not_settled,
            Severity::error,
            {},
            fmt::format("the result has not converged with {}", accuracy(refined.solver)),
            help};
  return {
      FindingCode::step_not_settled,
      Severity::error,
      {},
      fmt::format(
          "the result has not converged with {}, and finer ones were not tried: with {} {}, hardly less than with the step before",
          accuracy(refined.solver), refined.solver.finer_words(), moved(refined.moves.back())),
      help};
}

}  // namespace

bool refine_solver(Session& session, Task const& task, MakeTarget const& make, ObjectiveKind objective_kind,
                   SolverSettings const& stated, Preparation& preparation, RunContext& context) {
  // Modes may need fewer steps than far corners of the prior.
  if (preparation.solver != stated)
    preparation.modes = refit(*make(stated), objective_kind, preparation.modes, context.seed, context.ledger, context.interrupted);
  RefinedSolver refined = find_converged_solver(make, objective_kind, stated, std::move(preparation.modes), context);
  if (context.stop_requested()) return false;
  preparation.solver = refined.solver;
  preparation.modes = std::move(refined.modes);
  rank(objective_kind, preparation.modes);
  preparation.moves = refined.moves;
  // What looked like several may have been the solver's, and another may be the highest now.
  std::erase_if(preparation.findings, [](Finding const& each) {
    return each.code == FindingCode::second_mode || each.code == FindingCode::flat_direction;
  });
  Findings const found = mode_findings(*make(refined.solver), objective_kind, preparation.modes);
  preparation.findings.insert(preparation.findings.begin(), found.begin(), found.end());
  if (refined.solver != stated)
    session.notices << fmt::format("{}: {} (with {}, {} with {})\n", task.name, accuracy(refined.solver), accuracy(stated),
                                   moved(preparation.moves.front()), stated.finer_words());
  if (!refined.converged) preparation.findings.push_back(not_converged(refined));
  return true;
}

}  // namespace sysid
