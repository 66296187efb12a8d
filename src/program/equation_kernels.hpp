// The equations of motion as plain functions of one lane, for solvers that choose their own steps: right-hand sides and Jacobian,
// differentiated symbolically, compiled together.
#pragma once
#include <vector>

#include "program/kernel.hpp"
#include "program/uniform_leaf.hpp"

namespace sysid {

struct SimulationSource;  // program/simulation_program.hpp

/// Rows of the kernels' inputs: parameters, states, then `data`.
struct EquationKernels {
  int parameters = 0;
  int states = 0;
  std::vector<UniformLeaf> data;  // inputs, their rates, time: as far as they are read
  Kernel rates;                   // derivatives of the differential states, then residuals of the constraints
  Kernel jacobian;                // d(row i of `rates`)/d(state j) at [j * states + i]: columns, as linear solvers take them
};

EquationKernels compile_equation_kernels(SimulationSource const& source);

}  // namespace sysid
