// From the prior to the modes.
#include "search/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "core/numeric/elementary.hpp"
#include "core/numeric/order.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/failed_places.hpp"
#include "core/text/words.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/local_searches.hpp"
#include "search/mode_findings.hpp"
#include "search/search_step.hpp"
#include "search/starts.hpp"
#include "search/work_left.hpp"

namespace sysid {
namespace {

constexpr int draws_per_pass = 2048;
constexpr int early_rounds = 6;

// Steps of Purpose::start: the streams of this file never meet. Other files use some of these numbers again, for other purposes.
constexpr std::uint64_t search_step = 0, prior_start_step = 1'000, dispersal_step = 1'000'000;

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
        "check the units of the data and the priors: the data move the parameters out of the range in which the model has a "
        "solution";
  }
  return result;
}

/// Every search on the whole record.
SearchResult search_whole(Target const& target, ObjectiveKind objective_kind, RunContext& context) {
  std::vector<Mode> modes;
  Breadth const& breadth = breadth_of(target);
  std::uint64_t const round = simulations_per_round(target), of_draws = static_cast<std::uint64_t>(breadth.draws),
                      early = (breadth.likeliest + breadth.others) * early_rounds * round,
                      last_part = breadth.finalists * usual_rounds * round;
  int const passes = has_coefficients(target) ? 1 : most_passes;
  WorkLeft work(context, "searching the prior", of_draws + early + last_part);
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
    work.part(starts.size() * early_rounds * round, last_part);
    climb(*objective, starts, early_rounds, context.ledger, stop, context.journal);
    std::vector<Climber> last = choose_finalists(*objective, std::move(starts), breadth.finalists);
    // A density that vanishes at bounds has its optima inside: what was found there before is found to the last digit.
    int const rounds = objective_kind == ObjectiveKind::posterior ? most_rounds_inside : breadth.rounds;
    work.part(last.size() * usual_rounds * round, 0);
    finish(*objective, last, rounds, context.ledger, stop, context.journal);
    ended.insert(ended.end(), std::make_move_iterator(last.begin()), std::make_move_iterator(last.end()));
    if (stop()) break;
    if (!ended.empty()) modes = modes_of(*objective, ended, context.ledger, stop, context.journal);
    if (!modes.empty() && (ended.size() == 1 || !may_be_missed(modes, ended.size()))) break;
    if (pass + 1 < passes)
      work.next(fmt::format("searching the prior, pass {} of at most {}", pass + 2, passes), of_draws, early + last_part);
  }
  context.progress.end(!stop());
  return conclude(target, objective_kind, std::move(modes), begun, of_draws * static_cast<std::uint64_t>(passes), context);
}

}  // namespace

namespace {

/// Whether the residuals at a mode are correlated from one sample to the next, as those of a wrong model or of a wrong period are.
bool leaves_motion(Target const& target, Mode const& mode) {
  constexpr double much = 0.3;    // of the correlation from one sample to the next
  constexpr double far_off = 30;  // medians: single rows that carry the scale, not a sample, are larger, as are outliers
  Ledger untold;
  LaneArray rows(target.residual_count(), 1);
  target.residuals(to_lanes({theta_of(mode)}), rows, untold);
  std::vector<double> sizes;
  for (int r = 0; r < rows.rows(); ++r) sizes.push_back(std::fabs(rows(r, 0)));
  sort_numbers(sizes);
  double const limit = far_off * sorted_quantile(sizes, 0.5);
  auto const residual = [&](int r) { return std::fabs(rows(r, 0)) > limit ? 0 : rows(r, 0); };
  double square = 0, product = 0;
  for (int r = 0; r < rows.rows(); ++r) {
    square += residual(r) * residual(r);
    if (r > 0) product += residual(r) * residual(r - 1);
  }
  return std::fabs(product) > much * square;
}

/// Nats by which another search must be higher: its solver is a finer one.
constexpr double clearly_higher = 3;
constexpr int finer_at_second_look = 2;

/// A short record, on which a wrong frequency may fit worse than no motion: searched from its first rows, as long ones are, where
/// the best mode leaves motion in it.
void look_again(Target const& target, ObjectiveKind objective_kind, ShorterRecords const& records, RunContext& context,
                SearchResult& found) {
  auto const stop = [&] { return context.stop_requested(); };
  if (found.modes.empty() || target.is_estimated() || !can_grow(target, records)) return;
  bool const wanted = kept_answer(context.journal, stop, [&] { return leaves_motion(target, found.modes.front()); });
  if (!wanted && !stop()) return;
  if (stop()) {
    found.interrupted = true;
    found.modes.clear();
    return;
  }
  GrownModes grown = search_growing(target, objective_kind, records, context, finer_at_second_look);
  if (context.stop_requested()) {
    found.interrupted = true;
    found.modes.clear();
    return;
  }
  if (grown.modes.empty() || !(grown.modes.front().log_density > found.modes.front().log_density + clearly_higher)) return;
  found = conclude(target, objective_kind, std::move(grown.modes), true, grown.draws, context);
  found.finer = grown.finer;
}

}  // namespace

SearchResult search(Target const& target, ObjectiveKind objective_kind, RunContext& context, ShorterRecords const& records) {
  if (!worth_growing(target, records)) {
    SearchResult result = search_whole(target, objective_kind, context);
    if (!result.interrupted) look_again(target, objective_kind, records, context, result);
    return result;
  }
  GrownModes found = search_growing(target, objective_kind, records, context);
  SearchResult result = conclude(target, objective_kind, std::move(found.modes), found.begun, found.draws, context);
  result.finer = found.finer;
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

std::vector<int> spread_over_modes(std::vector<Mode> const& modes, int chains) {
  std::vector<int> count(modes.size(), 0);
  int left = chains;
  for (std::size_t m = 0; m < modes.size() && left > 0; ++m) {
    if (m > 0 && modes[m].share <= notable_share) continue;
    ++count[m];
    --left;
  }
  for (; left > 0; --left) {
    std::size_t most_wanting = 0;
    auto const want = [&](std::size_t m) { return modes[m].share * chains - count[m]; };
    for (std::size_t m = 1; m < modes.size(); ++m)
      if (want(m) > want(most_wanting)) most_wanting = m;
    ++count[most_wanting];
  }
  std::vector<int> mode_of_chain;
  for (std::size_t m = 0; m < modes.size(); ++m)
    mode_of_chain.insert(mode_of_chain.end(), static_cast<std::size_t>(count[m]), static_cast<int>(m));
  return mode_of_chain;
}

namespace {

/// Redraws the columns of `starts` until the density is finite at each; `redraw(chain, attempt)` gives the next try. Returns the
/// chains that never got one.
template <class Redraw>
std::vector<int> make_finite(Target const& target, LaneArray& starts, int attempts, Ledger& ledger, Redraw const& redraw) {
  std::vector<int> open(static_cast<std::size_t>(starts.width()));
  std::iota(open.begin(), open.end(), 0);
  for (int attempt = 0; attempt < attempts && !open.empty(); ++attempt) {
    std::vector<Eigen::VectorXd> points;
    for (int const chain : open) points.push_back(redraw(chain, attempt));
    LaneArray const theta = to_lanes(points);
    std::vector<double> prior(open.size()), likelihood(open.size());
    target.log_prior(theta, prior);
    target.log_likelihood(theta, likelihood, ledger);
    std::vector<int> still;
    for (std::size_t i = 0; i < open.size(); ++i) {
      for (int p = 0; p < starts.rows(); ++p) starts(p, open[i]) = theta(p, static_cast<int>(i));
      if (!std::isfinite(prior[i] + likelihood[i])) still.push_back(open[i]);
    }
    open = std::move(still);
  }
  return open;
}

}  // namespace

LaneArray overdispersed_starts(Target const& target, std::vector<Mode> const& modes, std::vector<int> const& mode_of_chain,
                               RunContext& context) {
  constexpr double inflation = 3;
  LaneArray starts(target.dimension(), static_cast<int>(mode_of_chain.size()));
  auto const mode_of = [&](int chain) -> Mode const& {
    return modes[static_cast<std::size_t>(mode_of_chain[static_cast<std::size_t>(chain)])];
  };
  auto const redraw = [&](int chain, int attempt) -> Eigen::VectorXd {
    Mode const& mode = mode_of(chain);
    Stream stream(
        {context.seed, Purpose::start, static_cast<std::uint64_t>(chain), dispersal_step + static_cast<std::uint64_t>(attempt)});
    Eigen::VectorXd z(target.dimension());
    for (double& v : z) v = stream.normal();
    Eigen::VectorXd const move = cholesky_or_diagonal(covariance_of(mode)) * z;
    return theta_of(mode) + inflation * move;
  };
  for (int const chain : make_finite(target, starts, 100, context.ledger, redraw))
    for (int p = 0; p < starts.rows(); ++p) starts(p, chain) = mode_of(chain).theta[static_cast<std::size_t>(p)];
  return starts;
}

std::optional<LaneArray> prior_starts(Target const& target, int chains, RunContext& context) {
  LaneArray starts(target.dimension(), chains);
  auto const redraw = [&](int chain, int attempt) {
    StreamKey const key{context.seed, Purpose::start, static_cast<std::uint64_t>(chain),
                        prior_start_step + static_cast<std::uint64_t>(attempt)};
    return column(draw_prior(target, key, 1), 0);
  };
  std::vector<int> const without = make_finite(target, starts, 1000, context.ledger, redraw);
  if (static_cast<int>(without.size()) == chains) return std::nullopt;
  // The others begin where those begin that have found a place.
  for (int const chain : without) {
    int lender = chain;
    do lender = (lender + 1) % chains;
    while (std::find(without.begin(), without.end(), lender) != without.end());
    for (int p = 0; p < starts.rows(); ++p) starts(p, chain) = starts(p, lender);
  }
  return starts;
}

Finding no_finite_start(Ledger const& ledger, std::uint64_t draws) {
  std::string const places = failed_places(ledger);
  return {
      FindingCode::no_finite_start,
      Severity::error,
      {},
      fmt::format("the likelihood is not finite at any of {} draws from the prior{}{}", draws, places.empty() ? "" : ": ", places),
      "check this part of the equations, or narrow the priors towards values for which the model can be solved"};
}

}  // namespace sysid
