// Three evaluations of the rates and one of the Jacobian; then sums over its rows.
#include "simulate/state_sizes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace sysid {

void raise_sizes(LaneEquations& equations, double time, double end, std::span<double const> states, SolverSettings const& solver,
                 std::span<double> sizes) {
  std::size_t const n = states.size(), differential = static_cast<std::size_t>(equations.differential());
  for (std::size_t i = 0; i < n; ++i) sizes[i] = std::max(sizes[i], std::fabs(states[i]));
  std::vector<double> rates(n), later(n), jacobian(n * n);
  // What is not finite fails in the solve that follows.
  if (!equations.rates(time, states.data(), rates.data()) || !equations.jacobian(time, states.data(), jacobian.data())) return;
  auto const slope = [&](std::size_t i, std::size_t j) { return std::fabs(jacobian[j * n + i]); };

  double fastest = 0;
  for (std::size_t i = 0; i < differential; ++i)
    for (std::size_t j = 0; j <= i; ++j) fastest = std::max(fastest, std::sqrt(slope(i, j)) * std::sqrt(slope(j, i)));
  double const tau = std::min(end - time, 1 / fastest);
  // What input and time will do, and what the states will: a rate may begin at zero, and at a kink its slope does, too.
  std::vector<double> ahead(states.begin(), states.end()), most(n);
  for (std::size_t i = 0; i < differential; ++i) ahead[i] += tau * rates[i];
  for (std::size_t i = 0; i < n; ++i) most[i] = std::fabs(rates[i]);
  auto const look = [&](double when, double const* where) {
    if (!equations.rates(when, where, later.data())) return;
    for (std::size_t i = 0; i < n; ++i) most[i] = std::max(most[i], std::fabs(later[i]));
  };
  look(end, states.data());
  look(time + tau, ahead.data());
  // A rate counts for tau, a constraint for how far it moves its own unknown.
  auto const weight = [&](std::size_t i) { return i < differential ? tau : slope(i, i) > 0 ? 1 / slope(i, i) : 0; };
  auto const row = [&](std::size_t i, auto const& of) {
    double sum = 0;
    for (std::size_t j = 0; j < n; ++j) sum += (i >= differential && j == i) || slope(i, j) == 0 ? 0 : slope(i, j) * of(j);
    return weight(i) * sum;
  };
  double const rounding = 4000 * std::numeric_limits<double>::epsilon() / solver.relative;
  std::vector<double> known(n);
  for (std::size_t i = 0; i < n; ++i) known[i] = std::max(sizes[i], weight(i) * most[i]);
  // From one to the next: a force moves a speed, a speed a place.
  for (std::size_t round = 0; round < n; ++round) {
    std::vector<double> const before = known;
    for (std::size_t i = 0; i < n; ++i)
      if (before[i] == 0) known[i] = row(i, [&](std::size_t j) { return before[j]; });
    if (known == before) break;
  }
  for (std::size_t i = 0; i < n; ++i) {
    double const noise = rounding * row(i, [&](std::size_t j) { return std::fabs(states[j]); });
    double const size = std::max(known[i], noise);
    if (std::isfinite(size)) sizes[i] = size;
  }
}

}  // namespace sysid
