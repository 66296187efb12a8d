// Matching by augmenting paths, and the total time derivative.
#include "model/index_reduction.hpp"

#include <algorithm>

namespace sysid {
namespace {

bool reads_unknown(Graph const& graph, NodeId root, std::size_t j) {
  return graph.depends(root, [&](Node const& node) {
    return node.operation == Operation::leaf && node.leaf_kind == LeafKind::unknown && node.index == static_cast<int>(j);
  });
}

/// Kuhn's augmenting path. Marks the equations it passed.
class Matching {
 public:
  Matching(Graph const& graph, std::vector<NodeId> const& residuals)
      : reads_(residuals.size()), equation_of_(residuals.size(), -1) {
    for (std::size_t i = 0; i < residuals.size(); ++i)
      for (std::size_t j = 0; j < residuals.size(); ++j)
        if (reads_unknown(graph, residuals[i], j)) reads_[i].push_back(j);
  }
  /// The equations that compete with `equation` when it finds no unknown of its own; empty when it does.
  std::vector<bool> place(std::size_t equation) {
    passed_.assign(reads_.size(), false);
    seen_.assign(reads_.size(), false);
    return augment(equation) ? std::vector<bool>() : passed_;
  }

 private:
  bool augment(std::size_t equation) {
    passed_[equation] = true;
    for (std::size_t const j : reads_[equation]) {
      if (seen_[j]) continue;
      seen_[j] = true;
      if (equation_of_[j] < 0 || augment(static_cast<std::size_t>(equation_of_[j]))) {
        equation_of_[j] = static_cast<int>(equation);
        return true;
      }
    }
    return false;
  }

  std::vector<std::vector<std::size_t>> reads_;
  std::vector<int> equation_of_;
  std::vector<bool> passed_, seen_;
};

}  // namespace

std::variant<NodeId, IndexFailure> time_derivative(Graph& graph, NodeId node, std::span<UnknownOrder const> unknowns) {
  NodeId sum = graph.constant(0);
  NodeId const roots[] = {node};
  for (NodeId const id : graph.reachable(roots)) {
    Node const leaf = graph[id];
    if (leaf.operation != Operation::leaf) continue;
    NodeId rate = graph.constant(0);
    switch (leaf.leaf_kind) {
      case LeafKind::state:
        for (std::size_t j = 0; j < unknowns.size(); ++j) {
          int const place = leaf.index - unknowns[j].first;
          if (place < 0 || place >= unknowns[j].order) continue;
          rate = place + 1 < unknowns[j].order ? graph.leaf(LeafKind::state, leaf.index + 1)
                                               : graph.leaf(LeafKind::unknown, static_cast<int>(j));
        }
        break;
      case LeafKind::input:
        rate = graph.leaf(LeafKind::input_rate, leaf.index);
        break;
      case LeafKind::time:
        rate = graph.constant(1);
        break;
      case LeafKind::unknown:
        return IndexFailure{IndexFailure::Kind::algebraic, 0, leaf.index};
      case LeafKind::input_rate:
        return IndexFailure{IndexFailure::Kind::input_rate, 0, leaf.index};
      default:
        continue;
    }
    sum = graph.add(sum, graph.multiply(graph.differentiate(node, id), rate));
  }
  return sum;
}

std::variant<IndexOne, IndexFailure> reduce_index(Graph& graph, std::span<NodeId const> residuals,
                                                  std::span<UnknownOrder const> unknowns) {
  IndexOne result{{residuals.begin(), residuals.end()}, {}};
  int most = 1;  // a constraint of the lowest components reaches the highest derivatives after as many differentiations
  for (UnknownOrder const& unknown : unknowns) most = std::max(most, unknown.order);
  std::vector<int> differentiated(residuals.size(), 0);
  for (bool done = false; !done;) {
    Matching matching(graph, result.residuals);
    done = true;
    for (std::size_t i = 0; i < residuals.size() && done; ++i) {
      std::vector<bool> const competing = matching.place(i);
      for (std::size_t e = 0; e < competing.size(); ++e) {
        if (!competing[e]) continue;
        done = false;
        auto const rate = time_derivative(graph, result.residuals[e], unknowns);
        if (auto const* failure = std::get_if<IndexFailure>(&rate))
          return IndexFailure{failure->kind, static_cast<int>(e), failure->index};
        if (++differentiated[e] > most || graph.constant_value(std::get<NodeId>(rate)))
          return IndexFailure{IndexFailure::Kind::overdetermined, static_cast<int>(i), 0};
        result.constraints.push_back({static_cast<int>(e), result.residuals[e]});
        if (auto const span = graph.span(result.residuals[e])) graph.set_span(std::get<NodeId>(rate), *span);
        result.residuals[e] = std::get<NodeId>(rate);
      }
    }
  }
  return result;
}

}  // namespace sysid
