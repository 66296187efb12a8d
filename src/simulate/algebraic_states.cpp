// Newton's method with the natural monotonicity test (Deuflhard 2011, sec. 3.3.2).
#include "simulate/algebraic_states.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sysid {
namespace {

constexpr int most_iterations = 50;
constexpr int most_halvings = 20;
constexpr double small_enough = 0.01;  // of the tolerances

}  // namespace

AlgebraicStates::AlgebraicStates(LaneEquations& equations, SolverSettings const& solver)
    : equations_(equations),
      solver_(solver),
      first_(static_cast<std::size_t>(equations.differential())),
      count_(static_cast<std::size_t>(equations.states()) - first_),
      reached_(count_),
      rates_(first_ + count_),
      jacobian_((first_ + count_) * (first_ + count_)),
      matrix_(count_ * count_),
      pivots_(count_) {}

bool AlgebraicStates::factor() {
  for (std::size_t k = 0; k < count_; ++k) {
    std::size_t best = k;
    for (std::size_t i = k + 1; i < count_; ++i)
      if (std::abs(matrix_[k * count_ + i]) > std::abs(matrix_[k * count_ + best])) best = i;
    if (matrix_[k * count_ + best] == 0) return false;
    pivots_[k] = best;
    for (std::size_t j = 0; j < count_; ++j) std::swap(matrix_[j * count_ + k], matrix_[j * count_ + best]);
    for (std::size_t i = k + 1; i < count_; ++i) {
      double const factor = matrix_[k * count_ + i] /= matrix_[k * count_ + k];
      for (std::size_t j = k + 1; j < count_; ++j) matrix_[j * count_ + i] -= factor * matrix_[j * count_ + k];
    }
  }
  return true;
}

void AlgebraicStates::back_substitute(std::vector<double>& x) const {
  // `factor` exchanges whole rows, multipliers included, so that the right-hand side is put in its final order first.
  for (std::size_t k = 0; k < count_; ++k) std::swap(x[k], x[pivots_[k]]);
  for (std::size_t k = 0; k < count_; ++k)
    for (std::size_t i = k + 1; i < count_; ++i) x[i] -= matrix_[k * count_ + i] * x[k];
  for (std::size_t k = count_; k-- > 0;) {
    x[k] /= matrix_[k * count_ + k];
    for (std::size_t i = 0; i < k; ++i) x[i] -= matrix_[k * count_ + i] * x[k];
  }
}

bool AlgebraicStates::correction(double time, double const* states, bool new_matrix, std::vector<double>& out) {
  if (!equations_.rates(time, states, rates_.data())) return false;
  if (new_matrix) {
    if (!equations_.jacobian(time, states, jacobian_.data())) return false;
    std::size_t const all = first_ + count_;
    for (std::size_t j = 0; j < count_; ++j)
      for (std::size_t i = 0; i < count_; ++i) matrix_[j * count_ + i] = jacobian_[(first_ + j) * all + first_ + i];
    if (!factor()) return false;
  }
  out.assign(rates_.begin() + static_cast<std::ptrdiff_t>(first_), rates_.end());
  back_substitute(out);
  return std::all_of(out.begin(), out.end(), [](double x) { return std::isfinite(x); });
}

bool AlgebraicStates::is_rounding(std::vector<double> const& correction, std::span<double const> states) const {
  std::size_t const all = first_ + count_;
  std::vector<double> allowed(count_), column(count_);
  for (std::size_t k = 0; k < count_; ++k) {
    double terms = 0;
    for (std::size_t j = 0; j < all; ++j) terms += std::abs(jacobian_[j * all + first_ + k] * states[j]);
    std::fill(column.begin(), column.end(), 0.0);
    column[k] = 8 * std::numeric_limits<double>::epsilon() * terms;
    back_substitute(column);
    for (std::size_t i = 0; i < count_; ++i) allowed[i] += std::abs(column[i]);
  }
  for (std::size_t i = 0; i < count_; ++i)
    if (!(std::abs(correction[i]) <= allowed[i])) return false;
  return true;
}

double AlgebraicStates::weighted(std::vector<double> const& correction, double const* states) const {
  double largest = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    double const size = std::abs(states[first_ + i]);
    double const allowed = solver_.relative * size + solver_.near_zero(std::max(reached_[i], size));
    largest = std::max(largest, std::abs(correction[i]) / allowed);
  }
  return largest;
}

StepFailure AlgebraicStates::failed(double time, std::span<double const> states) {
  if (!equations_.rates(time, states.data(), rates_.data()))
    return {FailureClass::non_finite, time, equations_.not_finite(time, states)};
  std::size_t worst = first_;
  for (std::size_t i = first_; i < rates_.size(); ++i)
    if (std::abs(rates_[i]) > std::abs(rates_[worst])) worst = i;
  return {FailureClass::inconsistent, time, equations_.equation(static_cast<int>(worst))};
}

std::optional<StepFailure> AlgebraicStates::solve(double time, std::span<double> states) {
  if (auto failure = iterate(time, states)) return failure;
  for (std::size_t i = 0; i < count_; ++i) reached_[i] = std::max(reached_[i], std::abs(states[first_ + i]));
  return std::nullopt;
}

std::optional<StepFailure> AlgebraicStates::iterate(double time, std::span<double> states) {
  std::vector<double> step, next, trial(states.begin(), states.end());
  double previous = std::numeric_limits<double>::infinity();
  for (int iteration = 0; iteration < most_iterations; ++iteration) {
    if (!correction(time, states.data(), true, step)) return failed(time, states);
    double const size = weighted(step, states.data());
    // Within the tolerances Newton's method converges quadratically; what does not shrink any more is rounding.
    if (size <= 1 && size > previous / 2) return std::nullopt;
    previous = size;
    double part = 1;
    bool smaller = false;
    for (int halving = 0; halving <= most_halvings && !smaller; ++halving, part /= 2) {
      for (std::size_t i = 0; i < count_; ++i) trial[first_ + i] = states[first_ + i] - part * step[i];
      smaller = size <= small_enough || (correction(time, trial.data(), false, next) && weighted(next, states.data()) < size);
    }
    if (!smaller && (size <= 1 || is_rounding(step, states))) return std::nullopt;
    if (!smaller) return failed(time, states);
    std::copy(trial.begin(), trial.end(), states.begin());
    if (size <= small_enough) return std::nullopt;
  }
  return failed(time, states);
}

}  // namespace sysid
