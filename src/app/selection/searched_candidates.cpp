// One search after another.
#include "app/selection/searched_candidates.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/search/record_search.hpp"
#include "app/search/solver_refinement.hpp"
#include "app/session/fit_target.hpp"
#include "core/system/interrupt.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "search/local_searches.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

class CandidateSearch {
 public:
  CandidateSearch(Session& session, Candidate const& candidate, std::uint64_t seed, Journal& journal, Findings& findings)
      : session_(session),
        candidate_(candidate),
        findings_(findings),
        context_{.seed = seed,
                 .progress = session.progress,
                 .ledger = ledger_,
                 .interrupted = [&session] { return session.interrupted(); },
                 .checkpoint_interval = 0,
                 .journal = &journal} {}

  std::optional<SearchedCandidate> run() {
    SolverSettings const stated = candidate_.fit.solver;
    SearchedCandidate found{{}, stated, {}};
    if (candidate_.space->dimension() == 0) return found;
    SearchableRecord const record = searchable_record();
    std::optional<SearchSolver> followed;
    if (record.refines()) {
      followed = choose_search_solver(record, context_);
      if (!followed) return std::nullopt;
      found.solver = followed->solver;
    }
    SearchResult search =
        sysid::search(*target(found.solver), ObjectiveKind::posterior, context_, shorter_records(record, found.solver));
    if (search.interrupted || session_.interrupted()) return std::nullopt;
    if (search.failure) {
      found.excluded = search.failure->message;
      return found;
    }
    SearchedWith const with = searched_with(record, search, found.solver);
    found.solver = with.solver;
    found.modes = std::move(search.modes);
    if (followed)
      for (Finding& each : stiff_prior(*followed, allow_exact_steps(candidate_.data, candidate_.compiled->model))) {
        each.names.push_back(name());
        each.message = fmt::format("`{}`: {}", name(), each.message);
        findings_.push_back(std::move(each));
      }
    if (record.refines()) refine(found, with.coarsest);
    if (session_.interrupted()) return std::nullopt;
    return found;
  }

 private:
  std::unique_ptr<ModelTarget> target(SolverSettings const& solver) const {
    return likelihood_target(session_, candidate_, solver, session_.interruptible());
  }
  std::string const& name() const { return candidate_.what->name; }

  SearchableRecord searchable_record() const {
    return {.session = session_,
            .name = name(),
            .what = candidate_.fit,
            .data = candidate_.data,
            .model = candidate_.compiled->model,
            .make = [this](std::vector<Experiment> experiments, SolverSettings const& solver) {
              return likelihood_target(session_, candidate_, std::move(experiments), solver, session_.interruptible());
            }};
  }

  /// from: the coarsest that is tried.
  void refine(SearchedCandidate& found, SolverSettings const& from) {
    // Modes may need fewer steps than far corners of the prior.
    if (found.solver != from)
      found.modes = refit(*target(from), ObjectiveKind::posterior, found.modes, context_.seed, ledger_, context_.interrupted,
                          nullptr, context_.journal);
    RefinedSolver refined = find_converged_solver([this](SolverSettings const& solver) { return target(solver); },
                                                  ObjectiveKind::posterior, from, std::move(found.modes), context_);
    found.solver = refined.solver;
    found.modes = std::move(refined.modes);
    rank(ObjectiveKind::posterior, found.modes);
    if (found.solver != from)
      session_.notices << fmt::format("the likelihood of `{}` is computed with {}, because {} would be too coarse\n", name(),
                                      found.solver.text(), from.text());
    if (found.modes.empty()) found.excluded = fmt::format("no mode is left with a solver finer than {}", from.text());
    if (!refined.converged)
      findings_.push_back({FindingCode::step_not_settled,
                           Severity::warning,
                           {name()},
                           fmt::format("the likelihood of `{}` has not converged even with {}", name(), found.solver.text()),
                           settling_advice(found.solver)});
  }

  Session& session_;
  Candidate const& candidate_;
  Findings& findings_;
  Ledger ledger_;  // of searches: those of a run that goes on read what is kept and simulate less
  RunContext context_;
};

}  // namespace

std::optional<std::vector<SearchedCandidate>> search_candidates(Session& session, std::vector<Candidate> const& candidates,
                                                                std::uint64_t seed, Journal& journal, Findings& findings) {
  std::vector<SearchedCandidate> all;
  for (Candidate const& each : candidates) {
    auto found = CandidateSearch(session, each, seed, journal, findings).run();
    if (!found) return std::nullopt;
    all.push_back(std::move(*found));
  }
  return all;
}

}  // namespace sysid
