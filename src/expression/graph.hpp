// Mathematical expressions as a hash-consed graph: equal sub-expressions are one node, constants fold as they are built.
// The checker builds models of it, order reduction solves in it, the program stage compiles from it. It knows no text, only spans.
#pragma once
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/text/source.hpp"

namespace sysid {

/// Index of a node in its Graph. Operands come before their users, so a pass over increasing ids is a topological order.
using NodeId = std::uint32_t;

struct Function;  // expression/function.hpp

enum class Operation : std::uint8_t {
  // leaves
  constant,  // value
  leaf,      // leaf_kind, index, stage
  // arithmetic
  negate,
  add,
  subtract,
  multiply,
  divide,
  power,  // a^b
  fused,  // a*b + c, rounded once; introduced by the program stage only
  square_root,
  absolute,
  sign,
  minimum,
  maximum,
  floor,
  // conditions are 1, 0, or NaN where a NaN was compared
  less,
  less_equal,
  equal,
  conjunction,
  disjunction,
  negation,
  select,  // a ? b : c
  call,    // one or two arguments, `function` says which
};

enum class LeafKind : std::uint8_t {
  parameter,      // declared value, coherent SI
  unconstrained,  // sampler's coordinate
  state,          // of the first-order system
  input,          // at the current time
  input_rate,     // its time derivative
  time,
  measured,     // the channel's sample at the current time
  process,      // an unknown function's value at the current sample
  previous,     // a remembered value, `index` says which, as it was at the sample before
  unknown,      // a highest derivative still to be solved for, or a place holder of a symbolic pass
  step_size,    // h of the integrator
  step_length,  // the same, read by what is computed once for all steps of that length
  control,      // a lane's step control: program/embedded.hpp
  interval,     // what step control reads of the data between two samples
  coefficient,  // of an input's polynomial there
  disturbance,  // white noise that nobody measured: `index` says which
};

/// Place within one integrator step where an input or time leaf is read: its begin, middle or end. Equations use `begin`.
enum class Stage : std::uint8_t { begin, middle, end };

struct Node {
  Operation operation = Operation::constant;
  LeafKind leaf_kind = LeafKind::parameter;
  Stage stage = Stage::begin;
  std::int32_t index = 0;
  std::int32_t lag = 0;  // samples back, of what discrete-time models read: input, time, measured, unknown
  double value = 0;
  Function const* function = nullptr;
  NodeId a = 0, b = 0, c = 0;
};

class Graph {
 public:
  // Building. Constants fold by `apply`; neutral elements vanish (x + 0, x*1, x/1, x^1, --x; x^0 and 1^x are 1; x*0, 0/x and x - x
  // are 0 whatever x, as in algebra); a minus sign goes into its sum (a + -b, a - -b, -1*a); a decided select is its branch;
  // operands of add, multiply, equal, conjunction and disjunction are put in one order. Nothing else is rewritten here: heavier
  // algebra belongs to the program stage. Constants are told apart by their bits (0 and -0 are two), and there is one NaN.
  NodeId constant(double value);
  NodeId leaf(LeafKind kind, int index = 0, Stage stage = Stage::begin, int lag = 0);
  NodeId negate(NodeId a);
  NodeId add(NodeId a, NodeId b);
  NodeId subtract(NodeId a, NodeId b);
  NodeId multiply(NodeId a, NodeId b);
  NodeId divide(NodeId a, NodeId b);
  NodeId power(NodeId a, NodeId b);
  NodeId fused(NodeId a, NodeId b, NodeId c);
  NodeId unary(Operation operation, NodeId a);             // square_root, absolute, sign, floor, negation
  NodeId binary(Operation operation, NodeId a, NodeId b);  // minimum, maximum, comparisons, conjunction, disjunction
  NodeId select(NodeId condition, NodeId then, NodeId otherwise);
  NodeId call(Function const& function, NodeId a);
  NodeId call(Function const& function, NodeId a, NodeId b);
  /// The same operation as `node` on other operands.
  NodeId rebuild(Node const& node, NodeId a, NodeId b, NodeId c);

  // Looking.
  Node const& operator[](NodeId id) const { return nodes_[id]; }
  std::size_t size() const { return nodes_.size(); }
  /// 0 to 3.
  int operand_count(NodeId id) const;
  std::optional<double> constant_value(NodeId id) const;
  bool is_constant(NodeId id, double value) const;
  /// Whether any leaf below `root` satisfies the predicate.
  bool depends(NodeId root, std::function<bool(Node const&)> const& predicate) const;
  /// All nodes below the roots, each once, in topological order.
  std::vector<NodeId> reachable(std::span<NodeId const> roots) const;

  // Where a node came from, for messages about it; the first span given stays.
  void set_span(NodeId id, Span span);
  std::optional<Span> span(NodeId id) const;

  // Symbolic work.
  /// d(root)/d(leaf). sign, floor, comparisons have derivative 0; absolute x: sign(x); min, max, select: by branch. Throws
  /// InternalError where a function on the way has no derivative.
  NodeId differentiate(NodeId root, NodeId leaf);
  /// `root` with every leaf replaced by `replacement(leaf id)`; nothing keeps the leaf.
  NodeId substitute(NodeId root, std::function<std::optional<NodeId>(NodeId)> const& replacement);
  std::vector<NodeId> substitute(std::span<NodeId const> roots, std::function<std::optional<NodeId>(NodeId)> const& replacement);
  /// The value of `root` with leaf values from `value_of(leaf id)`; the reference for every executor.
  double evaluate(NodeId root, std::function<double(NodeId)> const& value_of) const;
  std::vector<double> evaluate(std::span<NodeId const> roots, std::function<double(NodeId)> const& value_of) const;

  /// Infix text in the language's notation; leaf names from `name_of(leaf id)`. Parts above 20 000 characters are dots.
  std::string format(NodeId root, std::function<std::string(NodeId)> const& name_of) const;

 private:
  NodeId intern(Node node);
  std::vector<Node> nodes_;
  std::vector<Span> spans_;  // begin == end: none
  void grow_index();
  // Nodes by their hash, with free places between, so that a copy of a graph is three blocks of memory. A power of two of them.
  std::vector<NodeId> index_;
};

/// 0 to 3.
int operand_count(Node const& node);

/// The value of one operation on operand values: what folding, `evaluate` and the executors agree on, bit for bit.
/// sign is (a > 0) - (a < 0); minimum and maximum are (a < b ? a : b) and (a > b ? a : b); select takes b where a != 0; power is
/// elementary::pow (an executor that expands integer powers into products agrees to rounding only).
///
/// A NaN is never lost: minimum, maximum, comparisons and sign of a NaN are NaN, and so is a select whose condition is NaN.
/// Conditions follow Kleene: `and` with a 0 is 0, `or` with a true one is 1, whatever the other is, so that a guard guards.
double apply(Node const& node, double a, double b, double c);

}  // namespace sysid
