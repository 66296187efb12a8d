// Follows the modes on the stated solver and on finer ones; reports how far they moved and what did not converge.
#include "app/session/solver_refinement.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "search/refit.hpp"

namespace sysid {
namespace {

Finding not_settled(SettledSolver const& settled) {
  std::string const help = "if the model is stiff, fit it with `solver = cvode`; it may also be chaotic on this record";
  if (!settled.given_up)
    return {FindingCode::step_not_settled,
            Severity::error,
            {},
            fmt::format("the result has not converged with {}", accuracy(settled.solver)),
            help};
  return {FindingCode::step_not_settled,
          Severity::error,
          {},
          fmt::format("the result has not converged with {}, and finer ones were not tried: with {} {}, hardly less than before",
                      accuracy(settled.solver), settled.solver.finer_words(), moved(settled.moves.back())),
          help};
}

}  // namespace

bool refine_solver(Session& session, Task const& task, MakeTarget const& make, Aim aim, SolverSettings const& stated,
                   Preparation& preparation, RunContext& context) {
  // Modes may need fewer steps than far corners of the prior.
  if (preparation.solver != stated)
    preparation.modes = refit(*make(stated), aim, preparation.modes, context.seed, context.ledger, context.interrupted);
  SettledSolver settled = settle_solver(make, aim, stated, std::move(preparation.modes), context);
  if (context.stop_requested()) return false;
  preparation.solver = settled.solver;
  preparation.modes = std::move(settled.modes);
  preparation.moves = settled.moves;
  // What looked like several may have been the solver's.
  if (std::count_if(preparation.modes.begin(), preparation.modes.end(), [](Mode const& each) { return each.share > 0.01; }) < 2)
    std::erase_if(preparation.findings, [](Finding const& each) { return each.code == FindingCode::second_mode; });
  if (settled.solver != stated)
    session.notices << fmt::format("{}: {} (with {}, {} with {})\n", task.name, accuracy(settled.solver), accuracy(stated),
                                   moved(preparation.moves.front()), stated.finer_words());
  if (!settled.settled) preparation.findings.push_back(not_settled(settled));
  return true;
}

}  // namespace sysid
