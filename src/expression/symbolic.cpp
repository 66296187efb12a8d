// Symbolic passes over a graph: derivatives and substitution. Both walk in topological order, so depth costs no stack.
#include <string>

#include "core/numeric/elementary.hpp"
#include "core/text/diagnostic.hpp"
#include "expression/finite_slope.hpp"
#include "expression/function.hpp"
#include "expression/graph.hpp"

namespace sysid {
namespace {

NodeId log_derivative(Graph& graph, NodeId, NodeId a, NodeId, int) { return graph.divide(graph.constant(1), a); }

/// base^exponent as a factor of a derivative: where `held`, 0 instead of infinity at 0.
NodeId slope_factor(Graph& graph, NodeId base, NodeId exponent, bool held) {
  NodeId const factor = graph.power(base, exponent), zero = graph.constant(0);
  std::optional<double> const number = graph.constant_value(exponent);
  if (!held || (number && *number >= 0)) return factor;
  NodeId const zero_raised = graph.power(zero, exponent);
  NodeId const at_zero = graph.select(graph.binary(Operation::less, exponent, zero), zero, zero_raised);
  return graph.select(graph.binary(Operation::equal, base, zero), at_zero, factor);
}

/// d(a^b): the exponent's part is a^b log a, which tends to 0 as a falls to 0 for b > 0; log is kept finite there.
NodeId power_derivative(Graph& graph, NodeId power, Node const& node, NodeId da, NodeId db, bool held) {
  NodeId const one = graph.constant(1);
  NodeId const factor = held && graph.is_constant(da, 0) ? da : slope_factor(graph, node.a, graph.subtract(node.b, one), held);
  NodeId const by_base = graph.multiply(graph.multiply(node.b, factor), da);
  if (graph.is_constant(db, 0)) return by_base;
  NodeId const base = graph.select(graph.binary(Operation::equal, node.a, graph.constant(0)), one, node.a);
  NodeId const by_exponent = graph.multiply(graph.multiply(power, graph.call(log_function, base)), db);
  return graph.is_constant(da, 0) ? by_exponent : graph.add(by_base, by_exponent);
}

/// d(sqrt a)
NodeId root_derivative(Graph& graph, NodeId root, NodeId da, bool held) {
  NodeId const plain = graph.divide(da, graph.multiply(graph.constant(2), root));
  if (!held) return plain;
  return graph.select(graph.binary(Operation::equal, root, graph.constant(0)), graph.constant(0), plain);
}

}  // namespace

// The graph itself needs one elementary function, for the derivative of a power by its exponent.
Function const log_function{"log", 1, &elementary::log, &elementary::log_lanes, nullptr, nullptr, &log_derivative};

namespace {

/// Of one operation, where its operands change by da, db, dc: linear in these.
NodeId change_of(Graph& graph, NodeId id, NodeId da, NodeId db, NodeId dc, bool held) {
  Node const node = graph[id];  // a copy: the graph grows below
  NodeId const zero = graph.constant(0);
  switch (node.operation) {
    case Operation::negate:
      return graph.negate(da);
    case Operation::add:
      return graph.add(da, db);
    case Operation::subtract:
      return graph.subtract(da, db);
    case Operation::multiply: {
      NodeId const by_b = graph.multiply(node.a, db);
      return graph.add(graph.multiply(da, node.b), by_b);
    }
    case Operation::divide:
      return graph.divide(graph.subtract(da, graph.multiply(id, db)), node.b);
    case Operation::power:
      return power_derivative(graph, id, node, da, db, held);
    case Operation::fused: {
      NodeId const by_b = graph.multiply(node.a, db);
      return graph.add(graph.add(graph.multiply(da, node.b), by_b), dc);
    }
    case Operation::square_root:
      return root_derivative(graph, id, da, held);
    case Operation::absolute:
      return graph.multiply(graph.unary(Operation::sign, node.a), da);
    case Operation::minimum:
      return graph.select(graph.binary(Operation::less, node.a, node.b), da, db);
    case Operation::maximum:
      return graph.select(graph.binary(Operation::less, node.b, node.a), da, db);
    case Operation::select:
      return graph.select(node.a, db, dc);
    case Operation::call: {
      if (node.function->derivative == nullptr)
        throw InternalError("the derivative of `" + std::string(node.function->name) + "` is not known");
      NodeId const second = node.function->arity == 2 ? node.b : node.a;
      NodeId sum = zero;
      if (!graph.is_constant(da, 0)) sum = graph.multiply(node.function->derivative(graph, id, node.a, second, 0), da);
      if (!graph.is_constant(db, 0))
        sum = graph.add(sum, graph.multiply(node.function->derivative(graph, id, node.a, second, 1), db));
      return sum;
    }
    default:
      return zero;  // piecewise constant: sign, floor, conditions
  }
}

NodeId differentiate(Graph& graph, NodeId root, NodeId leaf, bool held) {
  std::vector<NodeId> const order = graph.reachable({&root, 1});
  NodeId const zero = graph.constant(0), one = graph.constant(1);
  std::vector<NodeId> derivative(root + std::size_t{1}, zero);
  for (NodeId const id : order) {
    if (id == leaf) {
      derivative[id] = one;
      continue;
    }
    Node const& node = graph[id];
    int const operands = operand_count(node);
    NodeId const da = operands > 0 ? derivative[node.a] : zero;
    NodeId const db = operands > 1 ? derivative[node.b] : zero;
    NodeId const dc = operands > 2 ? derivative[node.c] : zero;
    if (graph.is_constant(da, 0) && graph.is_constant(db, 0) && graph.is_constant(dc, 0)) continue;
    derivative[id] = change_of(graph, id, da, db, dc, held);
  }
  return derivative[root];
}

}  // namespace

NodeId Graph::differentiate(NodeId root, NodeId leaf) { return sysid::differentiate(*this, root, leaf, false); }

NodeId finite_slope(Graph& graph, NodeId root, NodeId leaf) { return differentiate(graph, root, leaf, true); }

NodeId finite_change(Graph& graph, NodeId id, NodeId da, NodeId db, NodeId dc) { return change_of(graph, id, da, db, dc, true); }

NodeId Graph::substitute(NodeId root, std::function<std::optional<NodeId>(NodeId)> const& replacement) {
  return substitute({&root, 1}, replacement).front();
}

std::vector<NodeId> Graph::substitute(std::span<NodeId const> roots,
                                      std::function<std::optional<NodeId>(NodeId)> const& replacement) {
  std::vector<NodeId> const order = reachable(roots);
  std::vector<NodeId> image(order.empty() ? 0 : order.back() + std::size_t{1});
  for (NodeId const id : order) {
    Node const node = nodes_[id];
    if (node.operation == Operation::leaf) {
      image[id] = replacement(id).value_or(id);
      continue;
    }
    int const operands = operand_count(id);
    NodeId const a = operands > 0 ? image[node.a] : 0, b = operands > 1 ? image[node.b] : 0, c = operands > 2 ? image[node.c] : 0;
    bool const unchanged = (operands < 1 || a == node.a) && (operands < 2 || b == node.b) && (operands < 3 || c == node.c);
    image[id] = unchanged ? id : rebuild(node, a, b, c);
    // Messages about the new node point at the old one's place; constants are shared by many places and get none.
    if (!unchanged && nodes_[image[id]].operation != Operation::constant)
      if (std::optional<Span> const place = span(id)) set_span(image[id], *place);
  }
  std::vector<NodeId> result;
  result.reserve(roots.size());
  for (NodeId const root : roots) result.push_back(image[root]);
  return result;
}

}  // namespace sysid
