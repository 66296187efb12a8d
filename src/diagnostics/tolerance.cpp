// Step halving against posterior width.
#include "diagnostics/tolerance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/text/words.hpp"
#include "search/laplace.hpp"
#include "search/refit.hpp"

namespace sysid {
namespace {

constexpr int most_substeps = 256;
constexpr double least_relative = 1e-12;

bool too_fine(SolverSettings const& solver) {
  return solver.fixed_step() ? solver.substeps > most_substeps : solver.relative < 0.99 * least_relative;
}

constexpr int checked_draws = 200;
constexpr std::uint64_t probe_step = 3;  // of Purpose::start
constexpr double of_weight = 0.01;       // share of a mode; others may move as they like

bool same_mode(Mode const& a, Mode const& b) { return std::isfinite(a.log_density) && distance(a, b) < 0.5; }

// Those that have come together, once, with their weights and hits.
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

// To first order only: far beyond a few sds the number means no more than "many".
std::string move_text(double move) { return move > 5 ? "many sds" : fmt::format("about {:.2g} sd", move); }

// chosen: by the guard itself, so that there is nothing to leave out.
// names: the parameters that move.
Finding shaped(SolverSettings const& solver, bool chosen, std::vector<std::string> names, std::string const& what) {
  return {FindingCode::integration_step, Severity::error, std::move(names),
          fmt::format("the integration {} changes the result: with {} {}", solver.fixed_step() ? "step" : "tolerance",
                      solver.finer_words(), what),
          chosen ? fmt::format("fit again with `{}` or finer", solver.finer().option())
          : solver.fixed_step()
              ? fmt::format("fit again with `{}` or more, or remove `substeps`, which is then chosen automatically",
                            solver.finer().option())
              : fmt::format("fit again with `{}`, or remove the tolerances, which are then chosen automatically",
                            solver.finer().option())};
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

SearchSolver search_solver(MakeTarget const& make, SolverSettings const& from, std::uint64_t seed) {
  SearchSolver result{from, 0};
  if (!from.fixed_step()) return result;
  constexpr int draws = 256;
  constexpr double tolerable = 0.2, worth_it = 0.05;
  double least = 1;
  SolverSettings solver = from;
  for (int factor = 1; factor <= 64; factor *= 4) {
    solver.substeps = from.substeps * factor;
    auto const target = make(solver);
    LaneArray theta(target->dimension(), draws);
    target->sample_prior({seed, Purpose::start, 0, probe_step}, theta);
    std::vector<double> density(draws);
    Ledger ignored;
    target->log_likelihood(theta, density, ignored);
    double const failed =
        static_cast<double>(std::count_if(density.begin(), density.end(), [](double v) { return !std::isfinite(v); })) / draws;
    if (factor == 1) result.failed_as_given = failed;
    if (factor == 1 || failed < least - worth_it) result.solver = solver, least = failed;
    if (failed <= tolerable) break;
  }
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
      : context_(context), before_(context.ledger.solves()), expected_(modes * solves_per_mode(target)) {
    context_.progress.begin(what, expected_);
  }
  ~Shown() { context_.progress.end(!context_.stop_requested()); }
  Shown(Shown const&) = delete;
  Shown& operator=(Shown const&) = delete;

  std::function<bool()> stop() const {
    return [this] {
      context_.progress.advance(std::min(context_.ledger.solves() - before_, expected_ - 1), "");
      return context_.stop_requested();
    };
  }

 private:
  /// A handful of rounds is usual.
  static std::uint64_t solves_per_mode(Target const& target) {
    auto const dimension = static_cast<std::uint64_t>(target.dimension());
    return target.has_gradient() ? 20 : 10 * (2 * dimension + 5) + 4 * (1 + 2 * dimension * dimension);
  }

  RunContext& context_;
  std::uint64_t before_, expected_;
};

/// By the most that one of weight does.
double largest_move(std::vector<Mode> const& modes, std::vector<Mode> const& finer) {
  double most = 0;
  for (std::size_t m = 0; m < finer.size(); ++m)
    if (m == 0 || modes[m].share > of_weight) most = std::max(most, largest_move(finer[m], modes[m]).size);
  return most;
}

}  // namespace

RefinedSolver find_converged_solver(MakeTarget const& make, ObjectiveKind objective_kind, SolverSettings const& from,
                                    std::vector<Mode> modes, RunContext& context) {
  RefinedSolver result;
  result.solver = from;
  result.modes = std::move(modes);
  double steps = 0;
  while (!context.stop_requested()) {
    SolverSettings const next = result.solver.finer();
    auto const target = make(next);
    std::uint64_t const before = context.ledger.solves();
    std::vector<Mode> const finer = [&] {
      Shown const shown(context, *target, result.modes.size(), fmt::format("trying {}", accuracy(next)));
      return refit(*target, objective_kind, result.modes, context.seed, context.ledger, shown.stop());
    }();
    steps += static_cast<double>(context.ledger.solves() - before) * target->residual_count() * next.substeps;
    result.moves.push_back(largest_move(result.modes, finer));
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
  return result;
}

double move_to_finer(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, std::uint64_t seed,
                     Ledger& ledger) {
  return largest_move(modes, refit(fine, objective_kind, modes, seed, ledger));
}

Findings check_modes(Target const& fine, ObjectiveKind objective_kind, std::vector<Mode> const& modes, SolverSettings const& solver,
                     std::uint64_t seed, Ledger& ledger) {
  std::vector<Mode> weighty;
  for (Mode const& mode : modes)
    if (weighty.empty() || mode.share > of_weight) weighty.push_back(mode);
  std::vector<Mode> const refined = refit(fine, objective_kind, weighty, seed, ledger);
  Findings findings;
  for (std::size_t m = 0; m < refined.size() && findings.empty(); ++m) {
    Move const move = largest_move(refined[m], weighty[m]);
    if (move.size <= tolerable_move) continue;
    auto const p = static_cast<std::size_t>(move.parameter);
    ParameterInfo const& parameter = fine.parameters()[p];
    std::string const unit = parameter.unit.empty() ? "" : " " + parameter.unit;
    if (!std::isfinite(move.size))
      findings.push_back(shaped(solver, false, {}, "the simulation fails at the optimum"));
    else if (2 * move.value >= move.size)
      findings.push_back(
          shaped(solver, false, {parameter.name}, fmt::format("{} moves by {}", parameter.name, move_text(move.value))));
    else
      findings.push_back(shaped(solver, false, {parameter.name},
                                fmt::format("the sd of {} is {:.2g}{} in place of {:.2g}{}", parameter.name, refined[m].sd[p], unit,
                                            weighty[m].sd[p], unit)));
  }
  if (std::size_t const apart = merged(refined).size(); apart < refined.size())
    findings.push_back(shaped(solver, false, {}, fmt::format("the {} modes that were found are {}", refined.size(), apart)));
  return findings;
}

ToleranceCheck check_tolerance(Target const& coarse, Target const& fine, Draws const& draws, Ledger& ledger) {
  LaneArray const declared = spread(draws, checked_draws);
  int const count = declared.width();
  ToleranceCheck result;
  if (count < 2) return result;
  int const dimension = coarse.dimension();
  LaneArray theta(dimension, count);
  coarse.unconstrain(declared, theta);
  std::vector<double> a(static_cast<std::size_t>(count)), b(a);
  coarse.log_likelihood(theta, a, ledger);
  fine.log_likelihood(theta, b, ledger);
  double mean_change = 0;
  for (std::size_t w = 0; w < a.size(); ++w) {
    a[w] = b[w] - a[w];
    if (!std::isfinite(a[w])) return {coarse.parameters().front().name, std::numeric_limits<double>::infinity()};
    mean_change += a[w] / count;
  }
  for (int p = 0; p < dimension; ++p) {
    double mean = 0, variance = 0, covariance = 0;
    for (int w = 0; w < count; ++w) mean += declared(p, w) / count;
    for (int w = 0; w < count; ++w) {
      variance += (declared(p, w) - mean) * (declared(p, w) - mean) / count;
      covariance += (declared(p, w) - mean) * (a[static_cast<std::size_t>(w)] - mean_change) / count;
    }
    double const move = variance > 0 ? std::abs(covariance) / std::sqrt(variance) : 0;
    if (move > result.move || result.parameter.empty()) result = {coarse.parameters()[static_cast<std::size_t>(p)].name, move};
  }
  return result;
}

Findings tolerance_findings(ToleranceCheck const& check, SolverSettings const& solver, bool chosen) {
  if (check.move <= tolerable_move) return {};
  return {
      shaped(solver, chosen, {check.parameter}, fmt::format("the mean of {} moves by {}", check.parameter, move_text(check.move)))};
}

}  // namespace sysid
