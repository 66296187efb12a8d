// From expressions to bytecode: order of evaluation, use of the accumulator, registers by linear scan.
#pragma once
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "expression/graph.hpp"
#include "program/bytecode/code.hpp"

namespace sysid {

/// A value to be computed; into register `target`, or wherever it is.
struct Goal {
  NodeId node = 0;
  std::optional<std::uint32_t> target;
};

struct Emitted {
  Code code;
  int temporaries = 0;
  std::vector<Operand> results;  // of each goal, after the last instruction: never the accumulator
};

/// Where values are that exist before the code runs (leaves, constants, hoisted values); nothing for those to be computed.
using Locate = std::function<std::optional<Operand>(NodeId)>;

enum class Order {
  goal_by_goal,  // each in full, the needier operand first
  eager,         // what ends a value's use comes as soon as it can: where many values are held at once
};

/// Straight-line code for the goals. Temporaries are registers first_temporary, first_temporary + 1, ... A target may be a register
/// that `locate` names as well (states are updated in place): every goal is computed from the values before.
Emitted emit(Graph const& graph, std::span<Goal const> goals, Locate const& locate, std::uint32_t first_temporary,
             Order order = Order::goal_by_goal);

}  // namespace sysid
