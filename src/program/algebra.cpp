// Rewriting by kind of node, and powers; products and sums have files of their own.
#include "program/algebra.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace sysid {

std::optional<int> integer_exponent(Graph const& graph, NodeId exponent) {
  std::optional<double> const value = graph.constant_value(exponent);
  if (!value || *value != std::floor(*value) || std::abs(*value) > largest_expanded_power || *value == 0) return std::nullopt;
  return static_cast<int>(*value);
}

NodeId integer_power(Graph& graph, NodeId base, int exponent) {
  if (exponent < 0) return graph.divide(graph.constant(1), integer_power(graph, base, -exponent));
  if (exponent == 1) return base;
  if (exponent % 2 != 0) return graph.multiply(base, integer_power(graph, base, exponent - 1));
  NodeId const half = integer_power(graph, base, exponent / 2);
  return graph.multiply(half, half);
}

std::vector<NodeId> expand_powers(Graph& graph, std::span<NodeId const> roots) {
  std::unordered_map<NodeId, NodeId> image;
  for (NodeId const id : graph.reachable(roots)) {
    Node const node = graph[id];
    int const operands = operand_count(node);
    NodeId const a = operands > 0 ? image.at(node.a) : 0, b = operands > 1 ? image.at(node.b) : 0,
                 c = operands > 2 ? image.at(node.c) : 0;
    if (operands == 0) {
      image[id] = id;
    } else if (node.operation == Operation::power && integer_exponent(graph, b)) {
      image[id] = integer_power(graph, a, *integer_exponent(graph, b));
    } else if (node.operation == Operation::power && graph.is_constant(b, 0.5)) {
      image[id] = graph.unary(Operation::square_root, a);
    } else {
      image[id] = graph.rebuild(node, a, b, c);
    }
  }
  std::vector<NodeId> result;
  for (NodeId const root : roots) result.push_back(image.at(root));
  return result;
}

Algebra::Algebra(Graph& graph, std::span<NodeId const> roots) : graph_(graph), binding_(graph), one_(graph.constant(1)) {
  std::vector<NodeId> const nodes = graph.reachable(roots);
  uses_.assign(nodes.empty() ? 0 : nodes.back() + std::size_t{1}, 0);
  for (NodeId const id : nodes) {
    Node const& node = graph[id];
    NodeId const operands[] = {node.a, node.b, node.c};
    for (int i = 0; i < operand_count(node); ++i) ++uses_[operands[i]];
  }
  for (NodeId const root : roots) ++uses_[root];
  find_shared_powers(roots);
}

/// x^n and x^(n-1) with a common exponent known only per parameter: one power, the other a product.
void Algebra::find_shared_powers(std::span<NodeId const> roots) {
  std::map<std::pair<NodeId, NodeId>, std::vector<std::pair<double, NodeId>>>
      groups;  // (base, rest of exponent) -> (offset, power)
  for (NodeId const id : graph_.reachable(roots)) {
    Node const node = graph_[id];
    if (node.operation != Operation::power || !binding_.is_step(id)) continue;
    Node const exponent = graph_[node.b];
    NodeId rest = node.b;
    double offset = 0;
    if (exponent.operation == Operation::constant) {
      rest = one_;
      offset = exponent.value;
      if (2 * offset == std::floor(2 * offset)) continue;  // products and square roots serve these better
    } else if (exponent.operation == Operation::add && graph_.constant_value(exponent.b)) {
      rest = exponent.a;
      offset = *graph_.constant_value(exponent.b);
    } else if (exponent.operation == Operation::subtract && graph_.constant_value(exponent.b)) {
      rest = exponent.a;
      offset = -*graph_.constant_value(exponent.b);
    }
    groups[{node.a, rest}].push_back({offset, id});
  }
  for (auto& [key, powers] : groups) {
    std::sort(powers.begin(), powers.end());
    for (auto const& [offset, id] : powers) {
      double const difference = offset - powers.front().first;
      if (difference >= 1 && difference == std::floor(difference) && difference <= largest_expanded_power)
        shared_[id] = {powers.front().second, static_cast<int>(difference)};
    }
  }
}

NodeId Algebra::rewrite(NodeId id) {
  if (!binding_.is_step(id)) return id;
  if (auto const found = rewritten_.find(id); found != rewritten_.end()) return found->second;
  Node const node = graph_[id];
  NodeId result = id;
  switch (node.operation) {
    case Operation::leaf:
      break;
    case Operation::negate:
    case Operation::add:
    case Operation::subtract: {
      std::vector<Product> terms;
      collect_terms(id, false, terms, true);
      result = sum(std::move(terms));
      break;
    }
    case Operation::multiply:
    case Operation::divide: {
      Product collected = unit();
      collect(id, 1, collected, true);
      result = product(collected);
      break;
    }
    case Operation::power:
      result = rewrite_power(id);
      break;
    default: {
      int const operands = operand_count(node);
      NodeId const a = rewrite(node.a), b = operands > 1 ? rewrite(node.b) : 0, c = operands > 2 ? rewrite(node.c) : 0;
      result = graph_.rebuild(node, a, b, c);
    }
  }
  return rewritten_[id] = result;
}

NodeId Algebra::rewrite_power(NodeId id) {
  Node const node = graph_[id];
  if (integer_exponent(graph_, node.b)) {
    Product collected = unit();
    collect(id, 1, collected, true);
    return product(collected);
  }
  NodeId const base = rewrite(node.a);
  if (std::optional<double> const exponent = graph_.constant_value(node.b)) {
    // x^(k/2) = sqrt(x) x^((k-1)/2)
    double const twice = 2 * *exponent;
    if (twice == std::floor(twice) && std::abs(twice) <= 2 * largest_expanded_power) {
      int const whole = static_cast<int>(std::floor(*exponent));
      NodeId const root = graph_.unary(Operation::square_root, base);
      if (whole == 0) return root;
      if (whole == -1) return graph_.divide(one_, root);
      if (whole > 0) return graph_.multiply(root, integer_power(graph_, base, whole));
      return graph_.divide(one_, graph_.multiply(root, integer_power(graph_, base, -whole - 1)));
    }
  }
  if (auto const found = shared_.find(id); found != shared_.end()) {
    // At 0 the product may be 0 times infinity where the power is not; there the power of 0, known per parameter vector, is taken.
    auto const [lowest, difference] = found->second;
    NodeId const zero = graph_.constant(0), shared = rewrite(lowest);
    NodeId const risen = graph_.multiply(integer_power(graph_, base, difference), shared);
    NodeId const at_zero = graph_.power(zero, rewrite(node.b));
    return graph_.select(graph_.binary(Operation::equal, base, zero), at_zero, risen);
  }
  return graph_.power(base, rewrite(node.b));
}

}  // namespace sysid
