// Error weights follow the size each state has reached, so that a passage through zero does not stop a solver.
#include "simulate/sundials_lane.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/diagnostic.hpp"
#include "simulate/state_sizes.hpp"

namespace sysid {

SundialsLane::SundialsLane(SundialsContext context, LaneEquations& equations, SolverSettings const& solver, bool (*stopped)())
    : context_(std::move(context)),
      equations_(equations),
      solver_(solver),
      stopped_(stopped),
      reached_(static_cast<std::size_t>(equations.states())),
      states_(make_vector()),
      matrix_(SUNDenseMatrix(equations.states(), equations.states(), *context_)),
      linear_(SUNLinSol_Dense(states_.get(), matrix_.get(), *context_)),
      bad_states_(reached_.size()) {}

Vector SundialsLane::make_vector() const { return Vector(N_VNew_Serial(equations_.states(), *context_)); }

void SundialsLane::require(int flag, char const* call) {
  if (flag < 0) throw InternalError(fmt::format("{} returned {}", call, flag));
}

int SundialsLane::weights(N_Vector states, N_Vector result, void* self) {
  auto& lane = *static_cast<SundialsLane*>(self);
  double const* y = N_VGetArrayPointer(states);
  double* weight = N_VGetArrayPointer(result);
  for (std::size_t i = 0; i < lane.count(); ++i) {
    double const size = std::abs(y[i]);
    if (!std::isfinite(size)) return -1;
    lane.reached_[i] = std::max(lane.reached_[i], size);
    weight[i] = 1 / (lane.solver_.relative * size + lane.solver_.near_zero(lane.reached_[i]));
  }
  return 0;
}

void SundialsLane::enter(double time, double end, std::span<double const> states) {
  bool const unknown = std::any_of(reached_.begin(), reached_.end(), [](double size) { return size == 0; });
  if (!entered_ || unknown) raise_sizes(equations_, time, end, states, solver_, reached_);
  entered_ = true;
}

bool SundialsLane::blocked(double reached, double last_step) const {
  double const resolved = 4 * std::numeric_limits<double>::epsilon() * std::abs(reached);
  return bad_time_ >= reached - (std::abs(last_step) < resolved ? solver_.steps * resolved : 0);
}

StepFailure SundialsLane::not_finite() {
  return {FailureClass::non_finite, bad_time_, equations_.not_finite(bad_time_, bad_states_)};
}

StepFailure SundialsLane::at_worst_state(FailureClass kind, double time, N_Vector errors) const {
  double const* error = N_VGetArrayPointer(errors);
  double const* y = N_VGetArrayPointer(states_.get());
  std::size_t worst = 0;
  double largest = -1;
  for (std::size_t i = 0; i < count(); ++i) {
    double const size = std::abs(error[i]) / (solver_.relative * std::abs(y[i]) + solver_.near_zero(reached_[i]));
    if (size > largest) worst = i, largest = size;
  }
  return {kind, time, equations_.equation(static_cast<int>(worst))};
}

}  // namespace sysid
