// From the prior to the modes.
#include "search/global/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/system/failed_places.hpp"
#include "search/descent.hpp"
#include "search/global/second_look.hpp"
#include "search/laplace.hpp"
#include "search/local_searches.hpp"
#include "search/mode_findings.hpp"
#include "search/starts.hpp"
#include "search/work_left.hpp"

namespace sysid {
namespace {

constexpr int draws_per_pass = 2048;
constexpr int early_rounds = 6;

constexpr std::uint64_t search_step = 0;  // of Purpose::start

/// The best of `climbers` that lie apart, filled up with the next best.
std::vector<Climber> choose_finalists(Objective const& objective, std::vector<Climber> climbers, std::size_t finalists) {
  sort_best_first(climbers);
  std::vector<Climber> chosen, rest;
  for (Climber& climber : climbers) {
    bool const apart =
        std::none_of(chosen.begin(), chosen.end(), [&](Climber const& other) { return in_one_basin(objective, climber, other); });
    (apart && chosen.size() < finalists ? chosen : rest).push_back(std::move(climber));
  }
  for (Climber& climber : rest)
    if (chosen.size() < finalists) chosen.push_back(std::move(climber));
  return chosen;
}

/// Local searches to their ends.
void finish(Objective const& objective, std::vector<Climber>& climbers, int rounds, Ledger& ledger,
            std::function<bool()> const& stop, Journal* journal) {
  climb(objective, climbers, rounds, ledger, stop, journal);
  settle_all(
      objective, climbers, [](std::size_t) { return std::numeric_limits<int>::max(); }, ledger, stop, journal);
}

/// Of modes that a search has found, if it has. begun: a draw had a finite density.
SearchResult conclude(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> modes, bool begun, std::uint64_t draws,
                      RunContext const& context) {
  SearchResult result;
  if (context.stop_requested()) {
    result.interrupted = true;
    return result;
  }
  result.modes = std::move(modes);
  if (!result.modes.empty()) {
    result.findings = mode_findings(target, objective_kind, result.modes);
    return result;
  }
  result.failure = no_finite_start(context.ledger, draws);
  if (begun) {  // draws are finite, but all climbs from them end where the likelihood does
    std::string const places = failed_places(context.ledger);
    result.failure->message = fmt::format("all local searches from prior draws end where the model cannot be simulated{}{}",
                                          places.empty() ? "" : ": ", places);
    result.failure->help =
        "check the units of the data, and the priors: where one is narrow and the data contradict it, the others are moved out of "
        "the range in which the model has a solution";
  }
  return result;
}

/// Every search on the whole record.
SearchResult search_whole(Target const& target, ObjectiveKind objective_kind, RunContext& context) {
  std::vector<Mode> modes;
  Breadth const& breadth = breadth_of(target);
  std::uint64_t const round = simulations_per_round(target), of_draws = static_cast<std::uint64_t>(breadth.draws),
                      early = (breadth.likeliest + breadth.others) * early_rounds * round;
  std::size_t finalists = breadth.finalists;
  auto const last_part = [&] { return finalists * usual_rounds * round; };
  int const passes = has_coefficients(target) ? 1 : most_passes;
  WorkLeft work(context, "searching the prior", of_draws + early + last_part());
  auto const stop = work.stop();
  StreamKey const key{context.seed, Purpose::start, 0, search_step};
  std::optional<Objective> objective;
  std::vector<Climber> ended;
  bool begun = false;
  for (int pass = 0; pass < passes && !stop(); ++pass) {
    LaneArray draws = draw_prior(target, key.with_index(static_cast<std::uint64_t>(pass * draws_per_pass)), draws_per_pass);
    if (!objective) objective.emplace(make_objective(target, objective_kind, draws));
    begin_without_functions(target, draws);
    std::vector<Climber> starts =
        choose_starts(*objective, draws.view().columns(0, breadth.draws), breadth, context.ledger, stop, context.journal);
    begun = begun || !starts.empty();
    work.part(starts.size() * early_rounds * round, last_part());
    climb(*objective, starts, early_rounds, context.ledger, stop, context.journal);
    std::vector<Climber> last = choose_finalists(*objective, std::move(starts), finalists);
    // A density that vanishes at bounds has its optima inside: what was found there before is found to the last digit.
    int const rounds = objective_kind == ObjectiveKind::posterior ? most_rounds_inside : breadth.rounds;
    work.part(last.size() * usual_rounds * round, 0);
    finish(*objective, last, rounds, context.ledger, stop, context.journal);
    ended.insert(ended.end(), last.begin(), last.end());
    if (stop()) break;
    if (!ended.empty()) modes = modes_of(*objective, ended, context.ledger, stop, context.journal);
    // One end is of one start, the only draw of the pass that could be solved: more passes would hardly have others.
    if (!modes.empty() && (ended.size() == 1 || !may_be_missed(modes, ended.size()))) break;
    finalists = next_finalists(*objective, modes, std::move(last), finalists, breadth.likeliest + breadth.others);
    if (pass + 1 < passes)
      work.next(fmt::format("searching the prior, pass {} of at most {}", pass + 2, passes), of_draws, early + last_part());
  }
  context.progress.end(!stop());
  return conclude(target, objective_kind, std::move(modes), begun, of_draws * static_cast<std::uint64_t>(passes), context);
}

}  // namespace

SearchResult search(Target const& target, ObjectiveKind objective_kind, RunContext& context, ShorterRecords const& records) {
  std::optional<GrownModes> found;
  if (!worth_growing(target, records)) {
    SearchResult whole = search_whole(target, objective_kind, context);
    if (whole.interrupted) return whole;
    found = second_look(target, objective_kind, records, context, whole.modes);
    if (!found && !context.stop_requested()) return whole;
    if (!found) found.emplace();
    found->begun = true;
  } else {
    found = search_growing(target, objective_kind, records, context);
  }
  SearchResult result = conclude(target, objective_kind, std::move(found->modes), found->begun, found->draws, context);
  result.finer = found->finer;
  return result;
}

SearchResult search_from(Target const& target, ObjectiveKind objective_kind, ConstLanes starts, RunContext& context,
                         std::string const& progress) {
  SearchResult result;
  WorkLeft work(context, progress, static_cast<std::uint64_t>(starts.width()) * simulations_per_round(target) * usual_rounds);
  auto const stop = work.stop();
  result.modes = modes_from(target, objective_kind, starts, -std::numeric_limits<double>::infinity(), context.seed, context.ledger,
                            stop, context.journal)
                     .modes;
  result.interrupted = stop();
  context.progress.end(!result.interrupted);
  if (result.interrupted) {
    result.modes.clear();
    return result;
  }
  if (result.modes.empty()) {
    result.failure = no_finite_start(context.ledger, static_cast<std::uint64_t>(starts.width()));
    return result;
  }
  result.findings = mode_findings(target, objective_kind, result.modes);
  return result;
}

Finding no_finite_start(Ledger const& ledger, std::uint64_t draws) {
  std::string const places = failed_places(ledger);
  return {
      FindingCode::no_finite_start,
      Severity::error,
      {},
      fmt::format("the likelihood is not finite at any of {} draws from the prior{}{}", draws, places.empty() ? "" : ": ", places),
      "check this part of the equations (for example for a noise sd of 0), or narrow the priors towards values for which the model "
      "can be solved"};
}

}  // namespace sysid
