// One pass over the nodes below the roots, each rebuilt from its rebuilt operands.
#include "program/frozen.hpp"

#include <map>
#include <optional>

namespace sysid {
namespace {

class Freezer {
 public:
  Freezer(Graph& graph, std::span<SwitchingSurface const> surfaces, std::span<NodeId const> sides) : graph_(graph) {
    for (std::size_t k = 0; k < surfaces.size(); ++k)
      if (!surfaces[k].at_integers) side_of_.emplace(surfaces[k].value, sides[k]);
  }

  std::vector<NodeId> operator()(std::span<NodeId const> roots) {
    for (NodeId const id : graph_.reachable(roots)) {
      Node const node = graph_[id];  // a copy: the graph grows
      int const operands = operand_count(node);
      NodeId const a = operands > 0 ? now_.at(node.a) : 0, b = operands > 1 ? now_.at(node.b) : 0;
      NodeId const c = operands > 2 ? now_.at(node.c) : 0;
      auto const held = decided(node, a, b);
      now_[id] = held ? *held : operands == 0 ? id : graph_.rebuild(node, a, b, c);
    }
    std::vector<NodeId> result;
    for (NodeId const root : roots) result.push_back(now_.at(root));
    return result;
  }

 private:
  std::optional<NodeId> side(NodeId value) const {
    auto const place = side_of_.find(value);
    return place == side_of_.end() ? std::nullopt : std::optional(place->second);
  }

  // What is held on a side has a value only where the surface has one: sqrt(h) > 2 does not hold for h < 0, nor its contrary.
  NodeId where_known(NodeId held, NodeId surface) {
    for (NodeId const id : graph_.reachable({&surface, 1})) {
      Operation const operation = graph_[id].operation;
      if (operation == Operation::square_root || operation == Operation::power || operation == Operation::divide ||
          operation == Operation::call)
        return graph_.add(held, graph_.binary(Operation::less, surface, surface));  // 0, or NaN
    }
    return held;
  }

  std::optional<NodeId> decided(Node const& node, NodeId a, NodeId b) {
    switch (node.operation) {
      case Operation::absolute:
        if (auto const s = side(node.a)) return graph_.multiply(*s, a);
        return std::nullopt;
      case Operation::sign:
        if (auto const s = side(node.a)) return where_known(*s, a);
        return std::nullopt;
      case Operation::minimum:
      case Operation::maximum:
      case Operation::less:
      case Operation::less_equal: {
        auto const s = side(graph_.subtract(node.a, node.b));
        if (!s) return std::nullopt;
        NodeId const difference = graph_.subtract(a, b);
        NodeId const below = where_known(graph_.binary(Operation::less, *s, graph_.constant(0)), difference);
        if (node.operation == Operation::minimum) return graph_.select(below, a, b);
        if (node.operation == Operation::maximum) return graph_.select(below, b, a);
        return below;
      }
      default:
        return std::nullopt;
    }
  }

  Graph& graph_;
  std::map<NodeId, NodeId> side_of_, now_;
};

}  // namespace

std::vector<NodeId> frozen(Graph& graph, std::span<NodeId const> roots, std::span<SwitchingSurface const> surfaces,
                           std::span<NodeId const> sides) {
  return Freezer(graph, surfaces, sides)(roots);
}

}  // namespace sysid
