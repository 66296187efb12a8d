// Building nodes: hash-consing, folding of constants, neutral elements; and the passes that only look.
//
// Ids decide the order of operands, and so how sums are rounded and products printed: every compiler must make nodes in the same
// order. Arguments of one call are evaluated in an order that C++ leaves open (GCC: from the last on x86-64, from the first on
// AArch64), so where two of them make nodes other than constants, one is made in a statement before.
#include "expression/graph.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/text/diagnostic.hpp"
#include "expression/function.hpp"

namespace sysid {
namespace {

constexpr NodeId free_place = std::numeric_limits<NodeId>::max();

std::uint64_t mix(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9e3779b97f4a7c15u;
  return hash ^ (hash >> 29);
}

std::uint64_t hash_of(Node const& node) {
  std::uint64_t hash = static_cast<std::uint64_t>(node.operation) | static_cast<std::uint64_t>(node.leaf_kind) << 8 |
                       static_cast<std::uint64_t>(node.stage) << 16 |
                       static_cast<std::uint64_t>(static_cast<std::uint32_t>(node.index)) << 32;
  hash = mix(hash, static_cast<std::uint32_t>(node.lag));
  hash = mix(hash, std::bit_cast<std::uint64_t>(node.value));
  hash = mix(hash, std::bit_cast<std::uintptr_t>(node.function));
  hash = mix(hash, static_cast<std::uint64_t>(node.a) << 32 | node.b);
  return mix(hash, node.c);
}

bool same(Node const& left, Node const& right) {
  return left.operation == right.operation && left.leaf_kind == right.leaf_kind && left.stage == right.stage &&
         left.index == right.index && left.lag == right.lag &&
         std::bit_cast<std::uint64_t>(left.value) == std::bit_cast<std::uint64_t>(right.value) && left.function == right.function &&
         left.a == right.a && left.b == right.b && left.c == right.c;
}

}  // namespace

NodeId Graph::intern(Node node) {
  int const operands = sysid::operand_count(node);
  bool fold = operands > 0;
  if (operands > 0) fold = fold && nodes_[node.a].operation == Operation::constant;
  if (operands > 1) fold = fold && nodes_[node.b].operation == Operation::constant;
  if (operands > 2) fold = fold && nodes_[node.c].operation == Operation::constant;
  if (fold)
    return constant(
        apply(node, nodes_[node.a].value, operands > 1 ? nodes_[node.b].value : 0, operands > 2 ? nodes_[node.c].value : 0));

  if (2 * nodes_.size() >= index_.size()) grow_index();
  std::size_t place = hash_of(node) & (index_.size() - 1);
  for (; index_[place] != free_place; place = (place + 1) & (index_.size() - 1))
    if (same(nodes_[index_[place]], node)) return index_[place];
  NodeId const id = static_cast<NodeId>(nodes_.size());
  nodes_.push_back(node);
  spans_.push_back({});
  index_[place] = id;
  return id;
}

void Graph::grow_index() {
  index_.assign(std::bit_ceil(std::max<std::size_t>(64, 4 * nodes_.size())), free_place);
  for (NodeId id = 0; id < nodes_.size(); ++id) {
    std::size_t place = hash_of(nodes_[id]) & (index_.size() - 1);
    while (index_[place] != free_place) place = (place + 1) & (index_.size() - 1);
    index_[place] = id;
  }
}

NodeId Graph::constant(double value) {
  // One NaN only: payload and sign of a NaN depend on the processor.
  return intern({.operation = Operation::constant, .value = std::isnan(value) ? std::numeric_limits<double>::quiet_NaN() : value});
}

NodeId Graph::leaf(LeafKind kind, int index, Stage stage, int lag) {
  return intern({.operation = Operation::leaf, .leaf_kind = kind, .stage = stage, .index = index, .lag = lag});
}

NodeId Graph::negate(NodeId a) {
  if (nodes_[a].operation == Operation::negate) return nodes_[a].a;
  return intern({.operation = Operation::negate, .a = a});
}

NodeId Graph::add(NodeId a, NodeId b) {
  if (is_constant(a, 0)) return b;
  if (is_constant(b, 0)) return a;
  if (nodes_[b].operation == Operation::negate) return subtract(a, nodes_[b].a);
  if (nodes_[a].operation == Operation::negate) return subtract(b, nodes_[a].a);
  bool const constant_a = constant_value(a).has_value(), constant_b = constant_value(b).has_value();
  if (constant_a != constant_b ? constant_a : b < a) std::swap(a, b);  // constants stand last: x + 1
  return intern({.operation = Operation::add, .a = a, .b = b});
}

NodeId Graph::subtract(NodeId a, NodeId b) {
  if (is_constant(b, 0)) return a;
  if (is_constant(a, 0)) return negate(b);
  if (a == b && !constant_value(a)) return constant(0);
  if (nodes_[b].operation == Operation::negate) return add(a, nodes_[b].a);
  return intern({.operation = Operation::subtract, .a = a, .b = b});
}

NodeId Graph::multiply(NodeId a, NodeId b) {
  bool const constant_a = constant_value(a).has_value(), constant_b = constant_value(b).has_value();
  if (constant_a != constant_b ? constant_b : b < a) std::swap(a, b);  // constants stand first: 2*x
  if (!(constant_a && constant_b)) {
    if (is_constant(a, 0)) return constant(0);
    if (is_constant(a, 1)) return b;
    if (is_constant(a, -1)) return negate(b);
  }
  return intern({.operation = Operation::multiply, .a = a, .b = b});
}

NodeId Graph::divide(NodeId a, NodeId b) {
  if (is_constant(b, 1)) return a;
  if (is_constant(b, -1)) return negate(a);
  if (is_constant(a, 0) && !constant_value(b)) return constant(0);
  return intern({.operation = Operation::divide, .a = a, .b = b});
}

NodeId Graph::power(NodeId a, NodeId b) {
  if (is_constant(b, 1)) return a;
  if (is_constant(b, 0) || is_constant(a, 1)) return constant(1);
  return intern({.operation = Operation::power, .a = a, .b = b});
}

NodeId Graph::fused(NodeId a, NodeId b, NodeId c) {
  if (b < a) std::swap(a, b);
  return intern({.operation = Operation::fused, .a = a, .b = b, .c = c});
}

NodeId Graph::unary(Operation operation, NodeId a) {
  switch (operation) {
    case Operation::negate:
      return negate(a);
    case Operation::square_root:
    case Operation::absolute:
    case Operation::sign:
    case Operation::floor:
    case Operation::negation:
      return intern({.operation = operation, .a = a});
    default:
      throw InternalError("Graph::unary: not an operation of one operand");
  }
}

NodeId Graph::binary(Operation operation, NodeId a, NodeId b) {
  switch (operation) {
    case Operation::add:
      return add(a, b);
    case Operation::subtract:
      return subtract(a, b);
    case Operation::multiply:
      return multiply(a, b);
    case Operation::divide:
      return divide(a, b);
    case Operation::power:
      return power(a, b);
    case Operation::minimum:
    case Operation::maximum:
      // Not put in order: with a NaN or zeros of both signs the two orders differ.
      if (a == b) return a;
      return intern({.operation = operation, .a = a, .b = b});
    case Operation::less:
    case Operation::less_equal:
      return intern({.operation = operation, .a = a, .b = b});
    case Operation::equal:
      if (b < a) std::swap(a, b);
      return intern({.operation = operation, .a = a, .b = b});
    case Operation::conjunction:
      if (is_constant(a, 0) || is_constant(b, 0)) return constant(0);
      if (is_constant(a, 1)) return b;
      if (is_constant(b, 1)) return a;
      if (b < a) std::swap(a, b);
      return intern({.operation = operation, .a = a, .b = b});
    case Operation::disjunction:
      if (is_constant(a, 1) || is_constant(b, 1)) return constant(1);
      if (is_constant(a, 0)) return b;
      if (is_constant(b, 0)) return a;
      if (b < a) std::swap(a, b);
      return intern({.operation = operation, .a = a, .b = b});
    default:
      throw InternalError("Graph::binary: not an operation of two operands");
  }
}

NodeId Graph::select(NodeId condition, NodeId then, NodeId otherwise) {
  if (then == otherwise) return then;
  if (std::optional<double> const value = constant_value(condition)) {
    if (std::isnan(*value)) return condition;
    return *value != 0 ? then : otherwise;
  }
  return intern({.operation = Operation::select, .a = condition, .b = then, .c = otherwise});
}

NodeId Graph::call(Function const& function, NodeId a) {
  if (function.arity != 1) throw InternalError("a function of two arguments was called with one");
  return intern({.operation = Operation::call, .function = &function, .a = a});
}

NodeId Graph::call(Function const& function, NodeId a, NodeId b) {
  if (function.arity != 2) throw InternalError("a function of one argument was called with two");
  return intern({.operation = Operation::call, .function = &function, .a = a, .b = b});
}

NodeId Graph::rebuild(Node const& node, NodeId a, NodeId b, NodeId c) {
  // `node` may lie inside nodes_: nothing of it is read after a node was added.
  switch (node.operation) {
    case Operation::constant:
      return constant(node.value);
    case Operation::leaf:
      return leaf(node.leaf_kind, node.index, node.stage, node.lag);
    case Operation::fused:
      return fused(a, b, c);
    case Operation::select:
      return select(a, b, c);
    case Operation::call:
      return node.function->arity == 1 ? call(*node.function, a) : call(*node.function, a, b);
    default:
      return sysid::operand_count(node) == 1 ? unary(node.operation, a) : binary(node.operation, a, b);
  }
}

int operand_count(Node const& node) {
  switch (node.operation) {
    case Operation::constant:
    case Operation::leaf:
      return 0;
    case Operation::negate:
    case Operation::square_root:
    case Operation::absolute:
    case Operation::sign:
    case Operation::floor:
    case Operation::negation:
      return 1;
    case Operation::fused:
    case Operation::select:
      return 3;
    case Operation::call:
      return node.function->arity;
    default:
      return 2;
  }
}

int Graph::operand_count(NodeId id) const { return sysid::operand_count(nodes_[id]); }

std::optional<double> Graph::constant_value(NodeId id) const {
  if (nodes_[id].operation != Operation::constant) return std::nullopt;
  return nodes_[id].value;
}

bool Graph::is_constant(NodeId id, double value) const {
  return nodes_[id].operation == Operation::constant && nodes_[id].value == value;
}

bool Graph::depends(NodeId root, std::function<bool(Node const&)> const& predicate) const {
  for (NodeId const id : reachable({&root, 1}))
    if (nodes_[id].operation == Operation::leaf && predicate(nodes_[id])) return true;
  return false;
}

std::vector<NodeId> Graph::reachable(std::span<NodeId const> roots) const {
  NodeId last = 0;
  for (NodeId const root : roots) last = std::max(last, root);
  std::vector<bool> marked(roots.empty() ? 0 : last + std::size_t{1});
  std::vector<NodeId> found;
  auto const mark = [&](NodeId id) {
    if (!marked[id]) found.push_back(id);
    marked[id] = true;
  };
  for (NodeId const root : roots) mark(root);
  for (std::size_t i = 0; i < found.size(); ++i) {
    Node const& node = nodes_[found[i]];
    int const operands = sysid::operand_count(node);
    if (operands > 0) mark(node.a);
    if (operands > 1) mark(node.b);
    if (operands > 2) mark(node.c);
  }
  // Few of a large graph are sorted, many are read off.
  if (found.size() < marked.size() / 16) {
    std::sort(found.begin(), found.end());
    return found;
  }
  found.clear();
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i]) found.push_back(static_cast<NodeId>(i));
  return found;
}

void Graph::set_span(NodeId id, Span span) {
  if (spans_[id].begin == spans_[id].end) spans_[id] = span;
}

std::optional<Span> Graph::span(NodeId id) const {
  if (spans_[id].begin == spans_[id].end) return std::nullopt;
  return spans_[id];
}

}  // namespace sysid
