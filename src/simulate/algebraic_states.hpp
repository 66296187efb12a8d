// Consistent values: algebraic states that satisfy their constraints for given differential states.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "simulate/lane_equations.hpp"
#include "simulate/stepper.hpp"

namespace sysid {

/// Damped Newton iteration on 0 = g(t, y_d, y_a) for y_a, from the values that y_a has:
///
///   y_a <- y_a - 2^-k (dg/dy_a)^-1 g,  the smallest k = 0, 1, ..., 20 for which the weighted correction at the new place is
///   smaller
///
/// (the natural monotonicity test: it does not depend on how equations are scaled). Ends when a full correction is below
/// a hundredth of what the solver's tolerances allow; or below what they allow, or below the rounding error of g, and not halved by
/// an iteration.
class AlgebraicStates {
 public:
  AlgebraicStates(LaneEquations& equations, SolverSettings const& solver);
  /// states: [states], the algebraic ones last, overwritten. A failure names the constraint that is violated most.
  std::optional<StepFailure> solve(double time, std::span<double> states);

 private:
  std::optional<StepFailure> iterate(double time, std::span<double> states);
  /// The Newton correction at `states`; false: not finite, or a singular matrix.
  bool correction(double time, double const* states, bool new_matrix, std::vector<double>& out);
  bool factor();
  void back_substitute(std::vector<double>& x) const;
  /// Whether a correction that does not shrink any more is no more than |(dg/dy_a)^-1| times the rounding error of g.
  bool is_rounding(std::vector<double> const& correction, std::span<double const> states) const;
  double weighted(std::vector<double> const& correction, double const* states) const;
  StepFailure failed(double time, std::span<double const> states);

  LaneEquations& equations_;
  SolverSettings solver_;
  std::size_t first_, count_;
  std::vector<double> reached_;                    // largest value of each algebraic state so far
  std::vector<double> rates_, jacobian_, matrix_;  // matrix: [count x count], column by column, factored
  std::vector<std::size_t> pivots_;
};

}  // namespace sysid
