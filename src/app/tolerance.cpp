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
constexpr int checked_draws = 200;

}  // namespace

SettledSubsteps settle_substeps(MakeTarget const& make, std::vector<Mode> modes, std::uint64_t seed, Ledger& ledger) {
  SettledSubsteps result;
  result.modes = std::move(modes);
  while (true) {
    std::vector<Mode> finer = refit(*make(2 * result.substeps), result.modes, seed, ledger);
    double move = 0;
    // Modes of no weight may move as they like.
    for (std::size_t m = 0; m < finer.size(); ++m)
      if (m == 0 || result.modes[m].share > 0.01) move = std::max(move, largest_move(finer[m], result.modes[m]));
    result.moves.emplace_back(result.substeps, move);
    if (move <= tolerable_move) return result;
    if (2 * result.substeps > most_substeps) {
      result.settled = false;
      return result;
    }
    result.substeps *= 2;
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

Findings tolerance_findings(ToleranceCheck const& check, int substeps) {
  if (check.move <= tolerable_move) return {};
  // To first order only: far beyond a few sds the number means no more than "many".
  std::string const move = check.move > 5 ? "many sds" : fmt::format("about {:.2g} sd", check.move);
  return {
      {Severity::error, "integration_step",
       fmt::format("the integration step shapes the result: with half the step the mean of {} moves by {}", check.parameter, move),
       fmt::format("fit again with `substeps = {}` or more, or leave `substeps` out and it is chosen", 2 * substeps)}};
}

}  // namespace sysid
