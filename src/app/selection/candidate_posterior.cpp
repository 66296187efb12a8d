// Modes near the particles of each candidate, and evidences from these modes.
#include "app/selection/candidate_posterior.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "app/search/solver_refinement.hpp"
#include "app/selection/likelihood_check.hpp"
#include "app/session/fit_target.hpp"
#include "core/numeric/elementary.hpp"
#include "diagnostics/tolerance/tolerance.hpp"

namespace sysid {
namespace {

/// By so many sds of its posterior the task's solver may put a candidate's particles off: they are spread by more.
constexpr double tolerable_offset = 0.5;

/// Nats below the most probable model from which on it does not matter how many.
constexpr double negligible = 30;

/// Follows the modes to finer solvers; a solver that the task states is only asked.
void refine_solver_of(Session& session, Candidate const& candidate, std::uint64_t seed, Journal& journal,
                      CandidatePosterior& posterior) {
  if (!candidate.compiled->model.integrated() || candidate.fit.solver.row().exact || posterior.modes.empty() ||
      posterior.modes.front().theta.empty())
    return;
  Ledger extra;
  if (!candidate.fit.refine_solver) {
    std::vector<Mode> const weightiest = {posterior.modes.front()};
    posterior.move = move_to_finer(
        *likelihood_target(session, candidate, candidate.fit.solver.finer(), session.interruptible()), ObjectiveKind::posterior,
        weightiest, seed, extra, [&] { return session.interrupted(); }, &journal);
    return;
  }
  MakeTarget const make = [&](SolverSettings const& solver) {
    return likelihood_target(session, candidate, solver, session.interruptible());
  };
  SilentProgress silent;  // one line for all candidates is shown already
  RunContext context{.seed = seed,
                     .progress = silent,
                     .ledger = extra,
                     .interrupted = [&] { return session.interrupted(); },
                     .checkpoint_interval = 0,
                     .journal = &journal};
  RefinedSolver refined =
      find_converged_solver(make, ObjectiveKind::posterior, candidate.fit.solver, std::move(posterior.modes), context);
  posterior.modes = std::move(refined.modes);
  if (refined.lost) posterior.modes.clear();  // places that only a coarse solver could reach are none
  // What is left is weighed as the finer one has it.
  std::stable_sort(posterior.modes.begin(), posterior.modes.end(),
                   [](Mode const& a, Mode const& b) { return a.log_mass > b.log_mass; });
  double const evidence = log_evidence(posterior.modes);
  for (Mode& mode : posterior.modes) mode.share = elementary::exp(mode.log_mass - evidence);
  posterior.solver = refined.solver;
  posterior.converged = refined.converged;
  if (!refined.moves.empty()) posterior.move = refined.moves.front();
}

}  // namespace

std::optional<std::vector<CandidatePosterior>> candidate_posteriors(Session& session, std::vector<Candidate> const& candidates,
                                                                    SelectionResult const& result, std::uint64_t seed,
                                                                    Journal& journal) {
  std::vector<CandidatePosterior> posteriors(candidates.size());
  Ledger extra;
  auto const stopped = [&] {
    bool const asked = session.interrupted();
    if (asked) session.progress.end(false);
    return asked;
  };
  session.progress.begin("computing likelihoods", candidates.size());
  // The most probable one first: it says how much is little.
  std::vector<std::size_t> order(candidates.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return result.models[a].probability > result.models[b].probability; });
  double best = -std::numeric_limits<double>::infinity();  // of what a model's probability is in proportion to
  for (std::size_t i = 0; i < order.size(); ++i) {
    std::size_t const k = order[i];
    SolverSettings const& solver = candidates[k].fit.solver;
    double const per_mass = log_unit(candidates[k], candidates.front()) + elementary::log(result.models[k].prior);
    LocalSearches found = modes_near(
        *likelihood_target(session, candidates[k], solver, session.interruptible()), result.models[k], best - per_mass - negligible,
        seed, extra, [&] { return session.interrupted(); }, &journal);
    if (stopped()) return std::nullopt;
    best = std::max(best, log_evidence(found.modes) + per_mass);
    posteriors[k] = {std::move(found.modes), found.given_up, solver, {}, true};
    session.progress.advance(i + 1, result.models[k].name);
  }
  // What a finer solver does to one may make another one worth a look.
  std::vector<bool> examined(candidates.size());
  std::string finer;  // told once the progress line is closed
  for (std::size_t k = 0; k < candidates.size();) {
    auto const checks = evidences(candidates, posteriors, result);
    bool const worth = result.models[k].probability >= worth_a_look || (checks[k] && checks[k]->probability >= worth_a_look);
    // What was given up lies too far below for a finer solver to matter, and has no mode to follow.
    if (examined[k] || !worth || posteriors[k].given_up) {
      ++k;
      continue;
    }
    examined[k] = true;
    refine_solver_of(session, candidates[k], seed, journal, posteriors[k]);
    if (posteriors[k].solver != candidates[k].fit.solver)
      finer += fmt::format("the likelihood of `{}` is computed with {}, because {} would be too coarse: with {}, {}\n",
                           candidates[k].what->name, posteriors[k].solver.text(), candidates[k].fit.solver.text(),
                           candidates[k].fit.solver.finer_words(), moved(*posteriors[k].move));
    if (stopped()) return std::nullopt;
    k = 0;
  }
  session.progress.end();
  session.notices << finer;
  return posteriors;
}

std::vector<std::optional<LikelihoodCheck>> evidences(std::vector<Candidate> const& candidates,
                                                      std::vector<CandidatePosterior> const& posteriors,
                                                      SelectionResult const& result) {
  std::vector<std::optional<LikelihoodCheck>> checks(candidates.size());
  std::vector<double> logs;  // of what a model's probability is in proportion to
  double highest = -std::numeric_limits<double>::infinity(), total = 0;
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    double const evidence = log_evidence(posteriors[k].modes) + log_unit(candidates[k], candidates.front());
    logs.push_back(evidence + elementary::log(result.models[k].prior));
    if (!std::isfinite(logs[k])) continue;  // nothing was found, which says nothing
    checks[k] = LikelihoodCheck{evidence, 0, {}, posteriors[k].given_up};
    if (candidates[k].compiled->model.integrated()) checks[k]->solver = posteriors[k].solver.text();
    highest = std::max(highest, logs[k]);
  }
  for (std::size_t k = 0; k < candidates.size(); ++k)
    if (checks[k]) total += checks[k]->probability = elementary::exp(logs[k] - highest);
  for (auto& check : checks)
    if (check) check->probability /= total;
  return checks;
}

Findings solver_findings(std::vector<Candidate> const& candidates, std::vector<CandidatePosterior> const& posteriors) {
  Findings findings;
  for (std::size_t k = 0; k < posteriors.size(); ++k) {
    CandidatePosterior const& posterior = posteriors[k];
    SolverSettings const& stated = candidates[k].fit.solver;
    if (posterior.move && *posterior.move > tolerable_offset) {
      std::string const finer = posterior.solver == stated ? stated.finer().option() : posterior.solver.option();
      findings.push_back({FindingCode::integration_step,
                          stated.as_model ? Severity::note : Severity::warning,
                          {candidates[k].what->name},
                          fmt::format("the particles of `{}` were simulated with {}, whose error changes parameters by {}, in "
                                      "units of the posterior that is computed from the likelihood",
                                      candidates[k].what->name, stated.text(),
                                      *posterior.move > 5 ? "more than 5 sds" : fmt::format("about {:.2g} sd", *posterior.move)),
                          stated.as_model ? "nothing, if the solver is meant to be part of the model"
                                          : fmt::format("select again with `{}`", finer)});
    }
    if (posterior.converged) continue;
    std::string const what =
        posterior.modes.empty()
            ? fmt::format("the likelihood of `{1}` is not finite at any mode near its particles when the solver is finer than {0}",
                          posterior.solver.text(), candidates[k].what->name)
            : fmt::format("the likelihood of `{}` has not converged even with {}", candidates[k].what->name,
                          posterior.solver.text());
    findings.push_back(
        {FindingCode::step_not_settled, Severity::warning, {candidates[k].what->name}, what, settling_advice(posterior.solver)});
  }
  return findings;
}

}  // namespace sysid
