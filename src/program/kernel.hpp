// A straight-line function of lane rows compiled from expressions: priors, transforms, derived quantities, tables of uniforms.
#pragma once
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "expression/graph.hpp"
#include "program/bytecode/code.hpp"

namespace sysid {

struct LinkedCode;  // program/interpreter/executor.hpp

struct Kernel {
  int inputs = 0;
  int outputs = 0;
  int registers = 0;              // rows of lanes: inputs first, then temporaries
  std::vector<double> constants;  // the uniforms
  Code code;
  std::vector<Operand> results;  // where each output is found after the last instruction; an input, a constant or a register
  std::shared_ptr<LinkedCode const> linked;
};

/// The function outputs(input_leaves). Any other leaf below an output is a fault of ours (InternalError).
/// Values agree with Graph::evaluate to a few ulp (integer powers are products, the rest is computed as written); they are the same
/// bytes for every width, position and instruction set.
Kernel compile_kernel(Graph const& graph, std::span<NodeId const> input_leaves, std::span<NodeId const> outputs);

/// inputs: [inputs x W], out: [outputs x W], any W; rows of `out` may not overlap those of `inputs`.
void run(Kernel const& kernel, ConstLanes inputs, Lanes out);
/// The same for one lane, by the scalar oracle: bit-equal.
void run_scalar(Kernel const& kernel, std::span<double const> inputs, std::span<double> out);

/// Readable text; input names from `name_of(input row)`.
std::string dump(Kernel const& kernel, std::function<std::string(int)> const& name_of);

}  // namespace sysid
