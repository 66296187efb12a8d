// Trial steps of the classical Runge-Kutta method, ten times shorter until a whole one and two halves agree.
#include "simulate/state_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

namespace sysid {
namespace {

constexpr int most_trials = 40;
constexpr double agreement = 0.1;
constexpr double epsilon = std::numeric_limits<double>::epsilon();

using Values = std::vector<double>;

/// Algebraic states stay where they are. Nothing when something is not finite.
std::optional<Values> trial_step(LaneEquations& equations, double time, Values const& from, double h) {
  auto const differential = static_cast<std::size_t>(equations.differential());
  auto const moved = [&](double part, Values const& rates) {
    Values to = from;
    for (std::size_t i = 0; i < differential; ++i) to[i] += part * rates[i];
    return to;
  };
  std::size_t const n = from.size();
  Values first(n), second(n), third(n), fourth(n);
  if (!equations.rates(time, from.data(), first.data())) return std::nullopt;
  if (!equations.rates(time + h / 2, moved(h / 2, first).data(), second.data())) return std::nullopt;
  if (!equations.rates(time + h / 2, moved(h / 2, second).data(), third.data())) return std::nullopt;
  if (!equations.rates(time + h, moved(h, third).data(), fourth.data())) return std::nullopt;
  for (std::size_t i = 0; i < differential; ++i) first[i] += 2 * (second[i] + third[i]) + fourth[i];
  Values const to = moved(h / 6, first);
  if (!std::all_of(to.begin(), to.end(), [](double y) { return std::isfinite(y); })) return std::nullopt;
  return to;
}

}  // namespace

void raise_sizes(LaneEquations& equations, double time, double end, std::span<double const> states, SolverSettings const& solver,
                 std::span<double> sizes) {
  std::size_t const n = states.size(), differential = static_cast<std::size_t>(equations.differential());
  for (std::size_t i = 0; i < n; ++i) sizes[i] = std::max(sizes[i], std::fabs(states[i]));
  Values const begin(states.begin(), states.end());
  Values jacobian(n * n), terms(n);
  if (!equations.jacobian(time, begin.data(), jacobian.data())) return;  // it fails in the solve that follows
  auto const slope = [&](std::size_t i, std::size_t j) { return std::fabs(jacobian[j * n + i]); };
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < n; ++j) terms[i] += slope(i, j) * std::fabs(begin[j]);

  double h = end - time;
  std::optional<Values> reached;
  for (int trial = 0; trial < most_trials && !reached; ++trial) {
    auto const whole = trial_step(equations, time, begin, h), middle = trial_step(equations, time, begin, h / 2);
    auto halves = middle ? trial_step(equations, time + h / 2, *middle, h / 2) : std::nullopt;
    bool agree = whole && halves;
    for (std::size_t i = 0; i < differential && agree; ++i) {
      // A whole step may be too short for a force to come through to the end of a chain.
      double const allowed = agreement * std::fabs((*halves)[i]) + 8 * epsilon * h * terms[i];
      agree = (*whole)[i] == 0 || std::fabs((*whole)[i] - (*halves)[i]) <= allowed;
    }
    if (agree)
      reached = std::move(halves);
    else
      h /= 10;
  }
  if (!reached) return;
  for (std::size_t i = 0; i < differential; ++i)
    sizes[i] = std::max({sizes[i], std::fabs((*reached)[i]), 4000 * epsilon / solver.relative * h * terms[i]});
  if (differential == n) return;
  Values residual(n);
  if (!equations.rates(time + h, reached->data(), residual.data())) return;
  for (std::size_t i = differential; i < n; ++i) {
    if (sizes[i] > 0 || slope(i, i) == 0) continue;
    double sum = std::fabs(residual[i]);
    for (std::size_t j = 0; j < n; ++j) sum += slope(i, j) * sizes[j];  // its own is 0
    if (std::isfinite(sum / slope(i, i))) sizes[i] = sum / slope(i, i);
  }
}

}  // namespace sysid
