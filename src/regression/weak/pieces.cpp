// Integration by parts, decided on the expression graph.
#include "regression/weak/pieces.hpp"

#include <algorithm>
#include <utility>

#include "regression/column/signals.hpp"

namespace sysid::regression {
namespace {

struct Addend {
  double factor;
  NodeId expression;
};

/// Sums and constant factors undone, so that each addend can go its own way.
void flatten(Graph const& graph, NodeId id, double factor, std::vector<Addend>& addends) {
  Node const& node = graph[id];
  switch (node.operation) {
    case Operation::add:
      flatten(graph, node.a, factor, addends);
      return flatten(graph, node.b, factor, addends);
    case Operation::subtract:
      flatten(graph, node.a, factor, addends);
      return flatten(graph, node.b, -factor, addends);
    case Operation::negate:
      return flatten(graph, node.a, -factor, addends);
    case Operation::multiply:
      if (auto const value = graph.constant_value(node.a)) return flatten(graph, node.b, factor * *value, addends);
      if (auto const value = graph.constant_value(node.b)) return flatten(graph, node.a, factor * *value, addends);
      break;
    case Operation::divide:
      if (auto const value = graph.constant_value(node.b)) return flatten(graph, node.a, factor / *value, addends);
      break;
    default:
      break;
  }
  addends.push_back({factor, id});
}

class PieceMaker {
 public:
  explicit PieceMaker(Dictionary& dictionary) : dictionary_(dictionary), graph_(dictionary.graph) {}

  bool add(Addend const& addend) {
    std::vector<Symbol> const symbols = symbols_below(dictionary_, {&addend.expression, 1});
    std::vector<Symbol> unmeasured;
    bool states = false;
    for (Symbol const& symbol : symbols) {
      if (symbol.kind != Symbol::Kind::state) continue;
      states = true;
      if (base_channel(dictionary_, symbol.index, symbol.order) < 0) return false;
      if (channel_of(dictionary_, symbol.index, symbol.order) < 0) unmeasured.push_back(symbol);
    }
    if (unmeasured.empty())
      pieces.push_back(
          {.kind = states ? Piece::Kind::samples : Piece::Kind::inputs, .factor = addend.factor, .expression = addend.expression});
    else if (!add_affine(addend, unmeasured))
      pieces.push_back({.factor = addend.factor, .expression = addend.expression, .smoothed = true});
    return true;
  }

  std::vector<Piece> pieces;

 private:
  bool reads_any(NodeId root, std::vector<Symbol> const& symbols) const {
    for (NodeId const id : graph_.reachable({&root, 1}))
      for (Symbol const& symbol : symbols)
        if (symbol.leaf == id) return true;
    return false;
  }

  /// Whether a branch, a sign or a floor turns on one of them: its derivative is 0 almost everywhere, and yet it is not constant.
  bool switches_on(NodeId root, std::vector<Symbol> const& symbols) const {
    for (NodeId const id : graph_.reachable({&root, 1})) switch (graph_[id].operation) {
        case Operation::sign:
        case Operation::floor:
        case Operation::less:
        case Operation::less_equal:
        case Operation::equal:
        case Operation::negation:
          if (reads_any(id, symbols)) return true;
          break;
        default:
          break;
      }
    return false;
  }

  /// addend = rest + sum_u c_u u over the unmeasured derivatives u, where no c_u reads one of them.
  bool add_affine(Addend const& addend, std::vector<Symbol> const& unmeasured) {
    if (switches_on(addend.expression, unmeasured)) return false;
    std::vector<Piece> found;
    for (Symbol const& symbol : unmeasured) {
      NodeId const coefficient = graph_.differentiate(addend.expression, symbol.leaf);
      if (reads_any(coefficient, unmeasured)) return false;
      int const channel = base_channel(dictionary_, symbol.index, symbol.order);
      int const moves = symbol.order - dictionary_.channels[static_cast<std::size_t>(channel)].order;
      if (auto const value = graph_.constant_value(coefficient)) {
        found.push_back({.kind = Piece::Kind::moved, .factor = addend.factor * *value, .channel = channel, .moves = moves});
      } else if (moves == 1 && reads_only(coefficient, symbol.index, symbol.order - 1)) {
        found.push_back(
            {.kind = Piece::Kind::potential, .factor = addend.factor, .expression = coefficient, .channel = channel, .moves = 1});
      } else {
        found.push_back({.factor = addend.factor, .expression = graph_.multiply(coefficient, symbol.leaf), .smoothed = true});
      }
    }
    NodeId const zero = graph_.constant(0);
    NodeId const rest = graph_.substitute(addend.expression, [&](NodeId id) -> std::optional<NodeId> {
      for (Symbol const& symbol : unmeasured)
        if (symbol.leaf == id) return zero;
      return std::nullopt;
    });
    pieces.insert(pieces.end(), found.begin(), found.end());
    if (graph_.is_constant(rest, 0)) return true;
    std::vector<Addend> addends;
    flatten(graph_, rest, addend.factor, addends);
    return std::all_of(addends.begin(), addends.end(), [&](Addend const& part) { return add(part); });
  }

  bool reads_only(NodeId root, int state, int order) const {
    for (Symbol const& symbol : symbols_below(dictionary_, {&root, 1}))
      if (symbol.kind != Symbol::Kind::state || symbol.index != state || symbol.order != order) return false;
    return true;
  }

  Dictionary& dictionary_;
  Graph& graph_;
};

}  // namespace

std::optional<std::vector<Piece>> weak_pieces(Dictionary& dictionary, NodeId expression) {
  std::vector<Addend> addends;
  flatten(dictionary.graph, expression, 1, addends);
  PieceMaker maker(dictionary);
  for (Addend const& addend : addends)
    if (!maker.add(addend)) return std::nullopt;
  return std::move(maker.pieces);
}

}  // namespace sysid::regression
