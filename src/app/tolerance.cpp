// Step halving against posterior width.
#include "app/tolerance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "inference/refit.hpp"

namespace sysid {
namespace {

constexpr int most_substeps = 256;
constexpr double least_relative = 1e-12;

bool too_fine(SolverSettings const& solver) {
  return solver.fixed_step() ? solver.substeps > most_substeps : solver.relative < 0.99 * least_relative;
}

constexpr int checked_draws = 200;

}  // namespace

SettledSolver settle_solver(MakeTarget const& make, SolverSettings const& from, std::vector<Mode> modes, std::uint64_t seed,
                            Ledger& ledger) {
  SettledSolver result;
  result.solver = from;
  result.modes = std::move(modes);
  while (true) {
    std::vector<Mode> finer = refit(*make(result.solver.finer()), result.modes, seed, ledger);
    double move = 0;
    // Modes of no weight may move as they like.
    for (std::size_t m = 0; m < finer.size(); ++m)
      if (m == 0 || result.modes[m].share > 0.01) move = std::max(move, largest_move(finer[m], result.modes[m]));
    result.moves.push_back(move);
    if (move <= tolerable_move) return result;
    if (too_fine(result.solver.finer())) {
      result.settled = false;
      return result;
    }
    result.solver = result.solver.finer();
    result.modes = std::move(finer);
  }
}

ToleranceCheck check_tolerance(ModelTarget const& coarse, ModelTarget const& fine, Draws const& draws, Ledger& ledger) {
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

Findings tolerance_findings(ToleranceCheck const& check, SolverSettings const& solver) {
  if (check.move <= tolerable_move) return {};
  // To first order only: far beyond a few sds the number means no more than "many".
  std::string const move = check.move > 5 ? "many sds" : fmt::format("about {:.2g} sd", check.move);
  return {{Severity::error, "integration_step",
           fmt::format("the integration {} shapes the result: with {} the mean of {} moves by {}",
                       solver.fixed_step() ? "step" : "tolerance", solver.finer_words(), check.parameter, move),
           solver.fixed_step()
               ? fmt::format("fit again with `{}` or more, or leave `substeps` out and it is chosen", solver.finer().option())
               : fmt::format("fit again with `{}`, or leave the tolerances out and they are chosen", solver.finer().option())}};
}

}  // namespace sysid
