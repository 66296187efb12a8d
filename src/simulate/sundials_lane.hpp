// What the SUNDIALS solvers share: vectors, matrix and linear solver of one trajectory, error weights, and where a failure was.
#pragma once
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

#include <limits>
#include <memory>
#include <sundials/sundials_context.hpp>

#include "simulate/lane_solver.hpp"

namespace sysid {

/// One context per block: SUNDIALS wants one per thread, and a block is run by one.
using SundialsContext = std::shared_ptr<sundials::Context>;

struct FreeVector {
  void operator()(N_Vector v) const { N_VDestroy(v); }
};
struct FreeMatrix {
  void operator()(SUNMatrix m) const { SUNMatDestroy(m); }
};
struct FreeLinearSolver {
  void operator()(SUNLinearSolver s) const { SUNLinSolFree(s); }
};
using Vector = std::unique_ptr<std::remove_pointer_t<N_Vector>, FreeVector>;
using Matrix = std::unique_ptr<std::remove_pointer_t<SUNMatrix>, FreeMatrix>;
using LinearSolver = std::unique_ptr<std::remove_pointer_t<SUNLinearSolver>, FreeLinearSolver>;

class SundialsLane : public LaneSolver {
 public:
  SundialsLane(SundialsContext context, LaneEquations& equations, SolverSettings const& solver, bool (*stopped)());
  /// Looks up the sizes of the states when the solve begins, and as long as there is one that has not moved.
  void enter(double time, double end, std::span<double const> states) override;

 protected:
  Vector make_vector() const;
  /// Throws InternalError when a call that cannot fail by the user's doing did.
  static void require(int flag, char const* call);
  /// Function handed to SUNDIALS: one over relative |y| + what is allowed near zero, from the largest |y| so far.
  static int weights(N_Vector states, N_Vector result, void* self);

  /// Whether it is a value that is not finite which keeps the solver from going beyond `reached`; last_step: its last step. The
  /// value lies ahead, or the solver stands still beside it: in steps that the clock does not resolve it spent its budget.
  bool blocked(double reached, double last_step) const;
  StepFailure not_finite();
  /// An iteration or error control that gave up: at the state whose `errors`, weighted, are largest.
  StepFailure at_worst_state(FailureClass kind, double time, N_Vector errors) const;

  /// Asked at every evaluation: one interval may take ten thousand steps.
  bool stopped() const { return stopped_ != nullptr && stopped_(); }
  static constexpr int give_up = -1;  // what a function returns to SUNDIALS then
  StepFailure given_up(double time) const { return {FailureClass::step_limit, time, std::nullopt}; }

  double* data(Vector const& v) const { return N_VGetArrayPointer(v.get()); }
  std::size_t count() const { return reached_.size(); }

  SundialsContext context_;
  LaneEquations& equations_;
  SolverSettings solver_;
  bool (*stopped_)();
  std::vector<double> reached_;
  bool entered_ = false;
  Vector states_;
  Matrix matrix_;
  LinearSolver linear_;
  // Where an evaluation was last not finite in this interval.
  double bad_time_ = never;
  std::vector<double> bad_states_;
  static constexpr double never = -std::numeric_limits<double>::infinity();
};

}  // namespace sysid
