// A built-in function as a row of data: how it is called, computed, differentiated. One file and one row adds another
// (function/table.cpp).
#pragma once
#include <span>
#include <string_view>

#include "core/numeric/elementary.hpp"
#include "expression/graph.hpp"

namespace sysid {

/// A primitive that executors call by pointer (exp, sin, lgamma, ...). Its scalar and lane forms are bit-equal.
struct Function {
  std::string_view name;
  int arity;  // 1 or 2
  elementary::Unary unary;
  elementary::UnaryLanes unary_lanes;
  elementary::Binary binary;
  elementary::BinaryLanes binary_lanes;
  /// d(call)/d(argument `which`), an expression in the arguments a, b; nullptr: not differentiable by us.
  NodeId (*derivative)(Graph&, NodeId call, NodeId a, NodeId b, int which);
};

/// The natural logarithm: the one function the graph itself needs, to differentiate a power by its exponent.
extern Function const log_function;

/// How the units of arguments and result relate.
enum class UnitRule {
  dimensionless,  // arguments and result have no dimension (exp)
  angle,          // the same, and the argument is in radians (sin)
  same,           // all arguments and the result share one unit (abs, min)
  root,           // result is the square root of the unit (sqrt)
  none,           // any argument, dimensionless result (sign)
  ratio,          // two arguments of one unit, dimensionless result (atan2)
  branches,       // condition, value, condition, value, ..., value: the values and the result share one unit (piecewise)
};

/// A name users can call: `sqrt(k/m)`. `build` makes the node, from a primitive or from operations.
struct FunctionRow {
  std::string_view name;
  int minimum_arguments;
  int maximum_arguments;  // INT_MAX: any number
  UnitRule unit_rule;
  NodeId (*build)(Graph&, std::span<NodeId const> arguments);
  std::string_view summary;  // one line for `sysid list functions` and the docs
};

}  // namespace sysid
