// One pass over the nodes in topological order, each with the kind of its dependence on what varies.
#include "solver/linear_structure.hpp"

#include <algorithm>
#include <functional>
#include <set>

namespace sysid {
namespace {

/// In this order: the kind of a sum is the largest of its terms.
enum class Kind { constant, other, linear, nonlinear };

using KindOfLeaf = std::function<Kind(Node const&)>;

/// `other`: what may be added to the linear part, but not multiply it.
Kind kind_of(Node const& node, Kind a, Kind b, Kind c) {
  Kind const largest = std::max({a, b, c});
  switch (node.operation) {
    case Operation::negate:
    case Operation::add:
    case Operation::subtract:
      return largest;
    case Operation::multiply:
      if (a == Kind::constant || b == Kind::constant) return largest;
      break;
    case Operation::divide:
      if (b == Kind::constant) return largest;
      break;
    case Operation::select:
      if (a == Kind::constant) return largest;
      break;
    default:
      break;
  }
  return largest < Kind::linear ? largest : Kind::nonlinear;
}

struct Culprit {
  NodeId node;
  bool product_with_other;
};

/// The nodes that are the first on their way up not to be linear.
std::vector<Culprit> culprits(Graph const& graph, std::span<NodeId const> roots, KindOfLeaf const& of_leaf) {
  std::vector<NodeId> const nodes = graph.reachable(roots);
  std::vector<Kind> kinds(nodes.empty() ? 0 : nodes.back() + std::size_t{1}, Kind::constant);
  std::vector<Culprit> result;
  for (NodeId const id : nodes) {
    Node const& node = graph[id];
    int const operands = operand_count(node);
    if (operands == 0) {
      kinds[id] = node.operation == Operation::leaf ? of_leaf(node) : Kind::constant;
      if (kinds[id] == Kind::nonlinear) result.push_back({id, false});
      continue;
    }
    Kind const a = kinds[node.a], b = operands > 1 ? kinds[node.b] : Kind::constant,
               c = operands > 2 ? kinds[node.c] : Kind::constant;
    kinds[id] = kind_of(node, a, b, c);
    bool const scales = node.operation == Operation::multiply || node.operation == Operation::divide;
    if (kinds[id] == Kind::nonlinear && std::max({a, b, c}) < Kind::nonlinear)
      result.push_back(
          {id, scales && std::min(a, b) == Kind::other && (node.operation == Operation::multiply || a == Kind::linear)});
  }
  return result;
}

Kind by_states(Node const& leaf) {
  switch (leaf.leaf_kind) {
    case LeafKind::parameter:
    case LeafKind::step_length:
      return Kind::constant;
    case LeafKind::input:
    case LeafKind::input_rate:
    case LeafKind::time:
    case LeafKind::disturbance:
      return Kind::other;
    case LeafKind::state:
      return Kind::linear;
    default:
      return Kind::nonlinear;  // what is neither known along a step nor a state
  }
}

/// A product of time and an input is no straight line where the input is one, and one of time and a disturbance is noise of another
/// intensity at each moment.
Kind by_time(Node const& leaf) {
  switch (leaf.leaf_kind) {
    case LeafKind::time:
      return Kind::linear;
    case LeafKind::input:
    case LeafKind::input_rate:
    case LeafKind::disturbance:
      return Kind::other;
    default:
      return Kind::constant;
  }
}

/// The same of an input and a disturbance.
Kind by_inputs(Node const& leaf) {
  switch (leaf.leaf_kind) {
    case LeafKind::input:
    case LeafKind::input_rate:
      return Kind::linear;
    case LeafKind::disturbance:
      return Kind::other;
    default:
      return Kind::constant;
  }
}

}  // namespace

std::optional<NotLinear> find_nonlinear(Graph const& graph, std::span<NodeId const> derivative) {
  if (std::vector<Culprit> const found = culprits(graph, derivative, &by_states); !found.empty())
    return NotLinear{found.front().product_with_other ? NotLinear::Why::varies : NotLinear::Why::nonlinear, found.front().node};
  if (std::vector<Culprit> const found = culprits(graph, derivative, &by_time); !found.empty())
    return NotLinear{NotLinear::Why::time, found.front().node};
  return std::nullopt;
}

std::vector<int> inputs_not_linear(Graph const& graph, std::span<NodeId const> derivative) {
  std::set<int> inputs;
  for (Culprit const& each : culprits(graph, derivative, &by_inputs))
    for (NodeId const id : graph.reachable({&each.node, 1}))
      if (graph[id].operation == Operation::leaf && by_inputs(graph[id]) == Kind::linear) inputs.insert(graph[id].index);
  return {inputs.begin(), inputs.end()};
}

}  // namespace sysid
