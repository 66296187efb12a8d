// From the prior to the modes.
#include "search/search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "core/numeric/elementary.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/failed_places.hpp"
#include "core/text/words.hpp"
#include "linear_algebra/decompositions.hpp"
#include "search/descent.hpp"
#include "search/laplace.hpp"
#include "search/local_searches.hpp"
#include "search/mode_findings.hpp"
#include "search/settle.hpp"
#include "search/work_left.hpp"

namespace sysid {
namespace {

constexpr int draws_per_pass = 2048;
constexpr int early_rounds = 6, usual_rounds = 15, most_rounds_inside = 100;
constexpr int patient_rounds = 300;    // along a curved valley, of searches that may end highest
constexpr double may_end_highest = 3;  // nats below the highest
constexpr int most_passes = 4;

/// How much a search looks at: of which draws it asks the density, and how many of them it climbs from.
struct Breadth {
  int draws;
  std::size_t likeliest, others, finalists;
  int rounds;  // of the finalists, before they are settled; of a target that has a gradient, evaluations
};
constexpr Breadth broad{draws_per_pass, 96, 32, 16, 30};
/// Of a likelihood that takes a matrix decomposition each time, and tells its gradient.
constexpr Breadth narrow{64, 6, 2, 4, 100};
/// Of an equation with an unknown function in it: what is not linear are the few other parameters, and every round asks for the
/// slopes of all coefficients.
constexpr Breadth few{draws_per_pass, 12, 4, 3, 100};

// Steps of Purpose::start: streams of different uses never meet.
constexpr std::uint64_t search_step = 0, prior_start_step = 1'000, dispersal_step = 1'000'000;

/// The draws worth a local search: the likeliest, and the first of the rest.
std::vector<Climber> choose_starts(Objective const& objective, ConstLanes draws, Breadth const& breadth, Ledger& ledger,
                                   std::function<bool()> const& stop, Journal* journal) {
  std::vector<double> const density = log_density_in_blocks(objective, draws, ledger, stop, journal);
  std::vector<int> order;
  for (int w = 0; w < draws.width(); ++w)
    if (std::isfinite(density[static_cast<std::size_t>(w)])) order.push_back(w);
  std::size_t const best = std::min(breadth.likeliest, order.size());
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(best), order.end(), [&](int a, int b) {
    double const fa = density[static_cast<std::size_t>(a)], fb = density[static_cast<std::size_t>(b)];
    return fa > fb || (fa == fb && a < b);
  });
  std::sort(order.begin() + static_cast<std::ptrdiff_t>(best), order.end());
  order.resize(std::min(order.size(), best + breadth.others));
  std::vector<Climber> starts;
  for (int const w : order) starts.push_back(climber_at(column(draws, w), density[static_cast<std::size_t>(w)]));
  return starts;
}

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

bool has_coefficients(Target const& target) {
  return std::any_of(target.parameters().begin(), target.parameters().end(),
                     [](ParameterInfo const& each) { return each.coefficient; });
}

/// Whether the best mode was met once, which may have a better neighbour that was not met, or modes are so many that others may
/// well be missing: of the places where searches can end, those not seen hold w (w + 1) / (n (n - 1)) for w modes after n searches
/// (Boender and Rinnooy Kan 1987).
bool may_be_missed(std::vector<Mode> const& modes, std::size_t searches) {
  constexpr double tolerable = 0.03, as_high = 0.01;
  constexpr int usual = 2;  // places, of a search of any size
  int places = 1, hits = modes.front().hits;
  for (std::size_t m = 1; m < modes.size(); ++m) {
    double const below = modes[m - 1].log_density - modes[m].log_density;
    if (std::fabs(below) > as_high) ++places;
    if (modes.front().log_density - modes[m].log_density < as_high) hits += modes[m].hits;
  }
  auto const w = static_cast<double>(places), n = static_cast<double>(searches);
  return hits < 2 || (places > usual && w * (w + 1) > tolerable * n * (n - 1));
}

/// Local searches to their ends.
void finish(Objective const& objective, std::vector<Climber>& climbers, int rounds, Ledger& ledger,
            std::function<bool()> const& stop, Journal* journal) {
  climb(objective, climbers, rounds, ledger, stop, journal);
  settle(objective, climbers, settling_rounds, ledger, stop, journal);
  sort_best_first(climbers);
  auto const low = std::find_if(climbers.begin(), climbers.end(), [&](Climber const& each) {
    return each.log_density < climbers.front().log_density - may_end_highest;
  });
  std::vector<Climber> highest(std::make_move_iterator(climbers.begin()), std::make_move_iterator(low));
  settle(objective, highest, patient_rounds, ledger, stop, journal);
  std::move(highest.begin(), highest.end(), climbers.begin());
}

LaneArray draw_prior(Target const& target, StreamKey key, int count) {
  LaneArray draws(target.dimension(), count);
  target.sample_prior(key, draws);
  return draws;
}

/// Coefficients of unknown functions at zero, where a model is what it is without them.
void begin_without_functions(Target const& target, LaneArray& draws) {
  for (int p = 0; p < target.dimension(); ++p)
    if (target.parameters()[static_cast<std::size_t>(p)].coefficient)
      for (int w = 0; w < draws.width(); ++w) draws(p, w) = 0;
}

}  // namespace

SearchResult search(Target const& target, ObjectiveKind objective_kind, RunContext& context) {
  SearchResult result;
  Breadth const& breadth = target.is_expensive() ? narrow : has_coefficients(target) ? few : broad;
  auto const dimension = static_cast<std::uint64_t>(target.dimension());
  std::uint64_t const round = target.is_expensive() ? 1 : 2 * dimension + 1 + 4,
                      of_draws = static_cast<std::uint64_t>(breadth.draws),
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
    if (!ended.empty()) result.modes = modes_of(*objective, ended, context.ledger, stop, context.journal);
    if (!result.modes.empty() && (ended.size() == 1 || !may_be_missed(result.modes, ended.size()))) break;
    if (pass + 1 < passes)
      work.next(fmt::format("searching the prior, pass {} of at most {}", pass + 2, passes), of_draws, early + last_part);
  }
  bool const stopped = stop();
  context.progress.end(!stopped);
  if (stopped) {
    result.interrupted = true;
    result.modes.clear();
    return result;
  }
  if (result.modes.empty()) {
    result.failure = no_finite_start(context.ledger, static_cast<std::uint64_t>(most_passes * breadth.draws));
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
  result.findings = mode_findings(target, objective_kind, result.modes);
  return result;
}

SearchResult search_from(Target const& target, ObjectiveKind objective_kind, ConstLanes starts, RunContext& context) {
  SearchResult result;
  auto const round = static_cast<std::uint64_t>(target.is_expensive() ? 1 : 2 * target.dimension() + 1 + 4);
  WorkLeft work(context, "searching near an earlier fit", static_cast<std::uint64_t>(starts.width()) * round * usual_rounds);
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
  if (!make_finite(target, starts, 1000, context.ledger, redraw).empty()) return std::nullopt;
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
