// Step halving against the widths of modes.
#include "diagnostics/tolerance/tolerance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text/words.hpp"
#include "search/laplace.hpp"
#include "search/mode/moves.hpp"
#include "search/refit.hpp"
#include "search/search_step.hpp"
#include "search/work_left.hpp"

namespace sysid {
namespace {

constexpr int most_substeps = 256;
constexpr double least_relative = 1e-12;

bool too_fine(SolverSettings const& solver) {
  return solver.fixed_step() ? solver.substeps > most_substeps : solver.relative < 0.99 * least_relative;
}

constexpr std::uint64_t probe_step = 3;  // of Purpose::start

bool same_mode(Mode const& a, Mode const& b) { return std::isfinite(a.log_density) && distance(a, b) < 0.5; }

}  // namespace

std::vector<Mode> merged(std::vector<Mode> const& modes) {
  std::vector<Mode> result;
  for (Mode const& mode : modes) {
    auto const same = std::find_if(result.begin(), result.end(), [&](Mode const& other) { return same_mode(other, mode); });
    if (same == result.end()) {
      result.push_back(mode);
      continue;
    }
    same->share += mode.share;
    same->hits += mode.hits;
  }
  return result;
}

namespace {

bool lost(Mode const& mode) { return !std::isfinite(mode.log_density); }

// `finer` without places that only the coarser solver could reach: nothing follows them, so they would converge with no solver. One
// that was lost before may yet come back with steps as fine as those of the search.
std::vector<Mode> reached(std::vector<Mode> const& coarser, std::vector<Mode> const& finer) {
  std::vector<Mode> left;
  double sum = 0;
  for (std::size_t m = 0; m < finer.size(); ++m) {
    if (lost(finer[m]) && !lost(coarser[m])) continue;
    left.push_back(finer[m]);
    sum += finer[m].share;
  }
  if (left.size() < finer.size())
    for (Mode& mode : left) mode.share = sum > 0 ? mode.share / sum : 1.0 / static_cast<double>(left.size());
  return left;
}

}  // namespace

std::string accuracy(SolverSettings const& solver) {
  return solver.fixed_step() ? counted(solver.substeps, "integrator step") + " per sample"
                             : fmt::format("relative tolerances of {}", solver.relative);
}

std::string moved(double move) {
  return std::isfinite(move) ? fmt::format("parameters move by up to {:.2g} sd", move)
                             : std::string("the simulation fails at a mode");
}

namespace {

constexpr int tried_by_stiff = 8;    // lost draws: enough to tell most from few
constexpr double of_a_trial = 1e-5;  // relative tolerance

/// The first of the columns whose density is not finite.
LaneArray failing(LaneArray const& theta, std::vector<double> const& density) {
  std::vector<int> lanes;
  for (int w = 0; w < theta.width() && static_cast<int>(lanes.size()) < tried_by_stiff; ++w)
    if (!std::isfinite(density[static_cast<std::size_t>(w)])) lanes.push_back(w);
  LaneArray result(theta.rows(), static_cast<int>(lanes.size()));
  for (int p = 0; p < theta.rows(); ++p)
    for (std::size_t w = 0; w < lanes.size(); ++w) result(p, static_cast<int>(w)) = theta(p, lanes[w]);
  return result;
}

/// Log likelihoods of prior draws, kept in blocks: with the finest solver a block takes as long as a search of many more draws.
class Trials {
 public:
  Trials(std::function<bool()> const& stop, Journal* journal) : stop_(stop), journal_(journal) {}

  std::vector<double> log_likelihood(Target const& target, ConstLanes theta) {
    constexpr int block = 128;
    return kept_values(journal_, "trial of a solver", theta.width(), block, ignored_, stop_, [&](int first, int count) {
      std::vector<double> out(static_cast<std::size_t>(count));
      target.log_likelihood(theta.columns(first, count), out, ignored_);
      return out;
    });
  }
  bool stopped() const { return stop_ && stop_(); }

 private:
  std::function<bool()> const& stop_;
  Journal* journal_;
  Ledger ignored_;
};

void try_stiff(MakeTarget const& make, LaneArray const& lost, Trials& trials, SearchSolver& result) {
  constexpr double budget = 4e5;  // steps of all draws together: about a second
  SolverSettings solver{.method = std::string(stiff_solver().name), .relative = of_a_trial};
  double const intervals = std::max(1.0, static_cast<double>(make(result.solver)->residual_count()) * lost.width());
  solver.steps = static_cast<int>(std::clamp(budget / intervals, 20.0, 1000.0));
  auto const target = make(solver);
  std::vector<double> const density = trials.log_likelihood(*target, lost);
  result.tried = lost.width();
  result.followed =
      static_cast<int>(std::count_if(density.begin(), density.end(), [](double value) { return std::isfinite(value); }));
}

}  // namespace

SearchSolver search_solver(MakeTarget const& make, SolverSettings const& from, std::uint64_t seed,
                           std::function<bool()> const& stop, Journal* journal) {
  SearchSolver result{from, 0};
  if (!from.fixed_step()) return result;
  constexpr int draws = 256;
  double least = 1;
  SolverSettings solver = from;
  LaneArray lost(0, 0);
  Trials trials(stop, journal);
  for (int factor = 1; factor <= 64; factor *= 4) {
    solver.substeps = from.substeps * factor;
    auto const target = make(solver);
    LaneArray theta(target->dimension(), draws);
    target->sample_prior({seed, Purpose::start, 0, probe_step}, theta);
    std::vector<double> const density = trials.log_likelihood(*target, theta);
    if (trials.stopped()) return result;
    double const failed =
        static_cast<double>(std::count_if(density.begin(), density.end(), [](double v) { return !std::isfinite(v); })) / draws;
    if (factor == 1) result.failed_as_given = failed;
    result.last_helped = factor > 1 && failed < least - SearchSolver::notable;
    if (factor == 1 || result.last_helped) {
      result.solver = solver;
      least = failed;
      lost = failing(theta, density);
    }
    if (failed <= SearchSolver::tolerable) break;
  }
  result.failed = least;
  if (least > SearchSolver::tolerable) try_stiff(make, lost, trials, result);
  return result;
}

namespace {

/// Integrator steps, of one simulation for one sample, after which one asks whether more of them may help: some seconds of an
/// equation with a handful of terms.
constexpr double patience = 2e8;

/// Whether moves that go on to fall as the last ones did, if they do, stay too large for every solver from `next` on.
bool hopeless(std::vector<double> const& moves, SolverSettings next) {
  if (moves.size() < 4) return false;  // a fast motion that coarse steps do not resolve moves for some halvings, too
  double move = moves.back();
  double const fall = std::min(1.0, move / moves[moves.size() - 2]);
  if (!std::isfinite(move) || !(fall > 0)) return false;  // what fails now may yet be stable
  for (; !too_fine(next); next = next.finer()) {
    move *= fall;
    if (move <= tolerable_move) return false;
  }
  return true;
}

/// A progress line over the solves of one refit.
class Shown {
 public:
  Shown(RunContext& context, Target const& target, std::size_t modes, std::string const& what)
      : context_(context), work_(context, what, modes * solves_per_mode(target)) {}
  ~Shown() { context_.progress.end(!context_.stop_requested()); }
  Shown(Shown const&) = delete;
  Shown& operator=(Shown const&) = delete;

  std::function<bool()> stop() { return work_.stop(); }

 private:
  /// A handful of rounds is usual.
  static std::uint64_t solves_per_mode(Target const& target) {
    auto const dimension = static_cast<std::uint64_t>(target.dimension());
    return target.is_expensive() ? 20 : 10 * (2 * dimension + 5) + 4 * (1 + 2 * dimension * dimension);
  }

  RunContext& context_;
  WorkLeft work_;
};

/// By the most that one of weight does.
Move largest_of_weight(Target const& target, std::vector<Mode> const& modes, std::vector<Mode> const& finer,
                       std::vector<double> const& gains) {
  Move most;
  for (std::size_t m = 0; m < finer.size(); ++m) {
    if (m > 0 && modes[m].share <= weight_of_interest) continue;
    Move const move = largest_move(target.parameters(), finer[m], modes[m], gains[m]);
    if (move.size() > most.size()) most = move;
  }
  return most;
}

/// One solver that was tried.
struct Tried {
  SolverSettings solver;
  std::vector<Mode> modes;
  double value;  // by which a value moves, at most, to the next finer one [sd]
};

/// The first from which on no value moves any more; where that is none but the last, which no other confirms, none.
std::size_t settled_values(std::vector<Tried> const& tried) {
  std::size_t first = tried.size();
  while (first > 0 && tried[first - 1].value <= tolerable_move) --first;
  return first + 1 < tried.size() ? first : tried.size();
}

}  // namespace

RefinedSolver find_converged_solver(MakeTarget const& make, ObjectiveKind objective_kind, SolverSettings const& from,
                                    std::vector<Mode> modes, RunContext& context) {
  RefinedSolver result;
  result.solver = from;
  result.modes = std::move(modes);
  double steps = 0;
  std::vector<Tried> tried;
  while (!context.stop_requested()) {
    SolverSettings const next = result.solver.finer();
    auto const target = make(next);
    std::uint64_t const before = context.ledger.solves();
    std::vector<double> gains;
    std::vector<Mode> const finer = [&] {
      Shown shown(context, *target, result.modes.size(), fmt::format("trying {}", accuracy(next)));
      return refit(*target, objective_kind, result.modes, context.seed, context.ledger, shown.stop(), &gains, context.journal);
    }();
    steps += static_cast<double>(context.ledger.solves() - before) * target->residual_count() * next.substeps;
    Move const move = largest_of_weight(*target, result.modes, finer, gains);
    result.moves.push_back(move.size());
    tried.push_back({result.solver, result.modes, move.value});
    if (result.moves.back() <= tolerable_move) break;
    std::vector<Mode> const left = reached(result.modes, finer);
    result.lost = left.empty();
    result.given_up = !result.lost && !too_fine(next) && steps > patience && hopeless(result.moves, next);
    if (result.lost || result.given_up || too_fine(next)) {
      result.converged = false;
      break;
    }
    result.solver = next;
    result.modes = merged(left);
  }
  if (std::size_t const settled = settled_values(tried); !result.converged && !result.lost && settled < tried.size()) {
    result.solver = tried[settled].solver;
    result.modes = std::move(tried[settled].modes);
    result.widths_alone = true;
  }
  return result;
}

double move_to_finer(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                     Ledger& ledger, std::function<bool()> const& stop, Journal* journal) {
  std::vector<double> gains;
  std::vector<Mode> const finer = refit(fine, objective_kind, modes, seed, ledger, stop, &gains, journal);
  return largest_of_weight(fine, modes, finer, gains).size();
}

}  // namespace sysid
