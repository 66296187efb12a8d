// The equations of motion of one lane at any time of one sampling interval: what solvers that choose their own steps evaluate.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "program/simulation_program.hpp"
#include "simulate/schedule.hpp"

namespace sysid {

class LaneEquations {
 public:
  LaneEquations(SimulationProgram const& program, Schedule const& schedule);

  int states() const { return program_.equations.states; }
  /// The first so many states have derivatives, the others are algebraic.
  int differential() const { return static_cast<int>(program_.source.derivative.size()); }
  /// Times are counted from the first sample, so that a late clock costs no digits.
  double time(int sample) const { return schedule_.time(sample) - schedule_.time(0); }

  /// The lane whose parameters are used, and the interval [sample, sample + 1] whose inputs are. At the last sample it is that
  /// sample alone: inputs are read from the right as at any other (Schedule::at_sample), rates from the left.
  void set_parameters(ConstLanes parameters, int lane);
  void set_interval(int sample);

  /// Derivatives of the differential states, then residuals of the constraints: [states]. False: something is not finite.
  bool rates(double time, double const* states, double* out);
  /// Their derivatives by the states, column by column: [states x states].
  bool jacobian(double time, double const* states, double* out);

  /// The derivative or residual that belongs to a state, of source.graph.
  NodeId equation(int state) const;
  /// The first sub-expression that is not finite there, of source.graph.
  std::optional<NodeId> not_finite(double time, std::span<double const> states);

 private:
  double data(UniformLeaf const& leaf, double time) const;
  bool run(Kernel const& kernel, double time, double const* states, std::vector<double>& registers, double* out);

  SimulationProgram const& program_;
  Schedule const& schedule_;
  std::vector<double> rates_, jacobian_;  // registers of the kernels
  int interval_ = 0;
  bool beyond_ = false;  // at the last sample, beyond its interval
};

}  // namespace sysid
