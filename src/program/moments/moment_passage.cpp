// The Cholesky factor, the points and what they give, written out entry by entry.
#include "program/moments/moment_passage.hpp"

#include <algorithm>
#include <cmath>

#include "expression/finite_slope.hpp"

namespace sysid {
namespace {

/// Whether the value jumps where states move: what the slopes, 0 on either side, do not show.
bool jumps_with_states(Graph const& graph, NodeId value) {
  auto const is_state = [](Node const& leaf) { return leaf.leaf_kind == LeafKind::state; };
  return std::ranges::any_of(graph.reachable({&value, 1}), [&](NodeId id) {
    Node const& node = graph[id];
    switch (node.operation) {
      case Operation::sign:
      case Operation::floor:
      case Operation::less:
      case Operation::less_equal:
      case Operation::equal:
        return graph.depends(id, is_state);
      case Operation::select:
        return graph.depends(node.a, is_state);
      default:
        return false;
    }
  });
}

}  // namespace

MomentPassage::MomentPassage(Graph& graph, std::vector<NodeId> const& means, Symmetric const& covariance, MomentRule rule,
                             int first_column)
    : graph_(graph), means_(means), covariance_(covariance), rule_(rule), first_column_(first_column), zero_(graph.constant(0)) {}

MomentRow MomentPassage::row(NodeId value) const {
  auto const reads_states = [&](NodeId id) {
    return graph_.depends(id, [](Node const& leaf) { return leaf.leaf_kind == LeafKind::state; });
  };
  MomentRow result{value, {}, true, {}};
  for (NodeId const state : means_) {
    result.slopes.push_back(finite_slope(graph_, value, state));
    result.linear = result.linear && !reads_states(result.slopes.back());
  }
  if (linearises() || !jumps_with_states(graph_, value)) return result;
  result.linear = false;
  for (NodeId const state : means_)
    result.read.push_back(graph_.depends(
        value, [&](Node const& leaf) { return leaf.leaf_kind == LeafKind::state && leaf.index == graph_[state].index; }));
  return result;
}

bool MomentPassage::moves(MomentRow const& row, int k) const {
  auto const state = static_cast<std::size_t>(k);
  return !is_zero(row.slopes[state]) || (!row.read.empty() && row.read[state]);
}

/// Made at the first need. A state whose variance is not positive, as that of a known start, has no column.
std::vector<MomentPassage::Point> const& MomentPassage::points() {
  if (!points_.empty()) return points_;
  std::vector<int> random;
  for (int k = 0; k < states(); ++k)
    if (int const i = (first_column_ + k) % states(); !is_zero(covariance_(i, i))) random.push_back(i);
  int const count = static_cast<int>(random.size());
  spread_ = std::max(count, 3);
  NodeId const scale = graph_.constant(std::sqrt(spread_));
  std::vector<std::vector<NodeId>> columns;  // of the factor, by state
  for (auto place = random.begin(); place != random.end(); ++place) {
    int const j = *place;
    Point point;
    point.state = j;
    std::vector<NodeId> column(static_cast<std::size_t>(states()), zero_);
    auto const left = [&](int i) {  // of P after the columns so far
      NodeId rest = covariance_(i, j);
      for (auto const& earlier : columns)
        rest = graph_.subtract(rest, graph_.multiply(earlier[static_cast<std::size_t>(i)], earlier[static_cast<std::size_t>(j)]));
      return rest;
    };
    // What rounding leaves of a variance that is zero is no spread.
    NodeId const pivot = left(j), least = graph_.multiply(graph_.constant(1e-13), covariance_(j, j));
    NodeId const positive = graph_.binary(Operation::less, graph_.binary(Operation::maximum, least, zero_), pivot);
    NodeId const root = graph_.unary(Operation::square_root, graph_.select(positive, pivot, graph_.constant(1)));
    column[static_cast<std::size_t>(j)] = graph_.select(positive, root, zero_);
    for (auto later = place + 1; later != random.end(); ++later)
      column[static_cast<std::size_t>(*later)] = graph_.select(positive, graph_.divide(left(*later), root), zero_);
    point.positive = positive;
    point.root = root;
    for (int i = 0; i < states(); ++i) {
      NodeId const offset = graph_.multiply(scale, column[static_cast<std::size_t>(i)]);
      point.offset.push_back(offset);
      point.ahead.push_back(graph_.add(means_[static_cast<std::size_t>(i)], offset));
      point.behind.push_back(graph_.subtract(means_[static_cast<std::size_t>(i)], offset));
    }
    columns.push_back(column);
    point.column = std::move(column);
    points_.push_back(std::move(point));
  }
  return points_;
}

NodeId MomentPassage::at(NodeId value, std::vector<NodeId> const& states) const {
  return graph_.substitute(value, [&](NodeId leaf) -> std::optional<NodeId> {
    Node const& node = graph_[leaf];
    return node.leaf_kind == LeafKind::state ? std::optional(states[static_cast<std::size_t>(node.index)]) : std::nullopt;
  });
}

MomentPassage::Values MomentPassage::values(NodeId value) {
  Values result;
  result.centre = value;
  NodeId sum = zero_;
  for (Point const& point : points()) {
    result.ahead.push_back(at(value, point.ahead));
    result.behind.push_back(at(value, point.behind));
    sum = graph_.add(sum, graph_.add(result.ahead.back(), result.behind.back()));
  }
  result.mean = graph_.multiply(weight(), sum);
  add_product(result.mean, centre_weight(), value);
  return result;
}

NodeId MomentPassage::expectation(MomentRow const& row) { return by_points(row) ? values(row.value).mean : row.value; }

/// By point: how a row differs ahead of the mean and behind it, beyond its slope.
std::vector<NodeId> MomentPassage::bent(MomentRow const& row) {
  std::vector<NodeId> result;
  Values const of = values(row.value);
  for (std::size_t p = 0; p < points_.size(); ++p) {
    NodeId straight = zero_;
    for (int k = 0; k < states(); ++k)
      add_product(straight, row.slopes[static_cast<std::size_t>(k)], points_[p].offset[static_cast<std::size_t>(k)]);
    NodeId const twice = graph_.multiply(graph_.constant(2), straight);
    result.push_back(graph_.subtract(graph_.subtract(of.ahead[p], of.behind[p]), twice));
  }
  return result;
}

NodeId MomentPassage::with_state(MomentRow const& row, int j) {
  NodeId sum = zero_;
  for (int k = 0; k < states(); ++k) add_product(sum, row.slopes[static_cast<std::size_t>(k)], covariance_(k, j));
  if (!by_points(row)) return sum;
  NodeId rest = zero_;
  std::vector<NodeId> const bends = bent(row);
  for (std::size_t p = 0; p < points_.size(); ++p) add_product(rest, points_[p].offset[static_cast<std::size_t>(j)], bends[p]);
  return graph_.add(sum, graph_.multiply(weight(), rest));
}

NodeId MomentPassage::between(MomentRow const& a, MomentRow const& b) {
  NodeId sum = zero_;
  if (by_points(a) && by_points(b)) {
    Values const of_a = values(a.value), of_b = values(b.value);
    auto const product = [&](NodeId left, NodeId right) {
      NodeId const second = graph_.subtract(right, of_b.mean);
      return graph_.multiply(graph_.subtract(left, of_a.mean), second);
    };
    for (std::size_t p = 0; p < points_.size(); ++p) {
      NodeId const behind = product(of_a.behind[p], of_b.behind[p]);
      sum = graph_.add(sum, graph_.add(product(of_a.ahead[p], of_b.ahead[p]), behind));
    }
    sum = graph_.multiply(weight(), sum);
    add_product(sum, centre_weight(), product(of_a.centre, of_b.centre));
    return sum;
  }
  bool const swap = by_points(b);
  MomentRow const &whole = swap ? b : a, &linear = swap ? a : b;
  for (int k = 0; k < states(); ++k)
    if (!is_zero(linear.slopes[static_cast<std::size_t>(k)]))
      add_product(sum, linear.slopes[static_cast<std::size_t>(k)], with_state(whole, k));
  return sum;
}

NodeId MomentPassage::variance(MomentRow const& row, std::vector<NodeId> const& with_states) {
  if (by_points(row)) return between(row, row);
  NodeId sum = zero_;
  for (int k = 0; k < states(); ++k)
    add_product(sum, row.slopes[static_cast<std::size_t>(k)], with_states[static_cast<std::size_t>(k)]);
  return sum;
}

std::vector<NodeId> MomentPassage::moved(std::vector<MomentRow> const& rows, std::vector<NodeId> const& column) {
  std::vector<NodeId> result, whitened;
  for (MomentRow const& row : rows) {
    NodeId sum = zero_;
    for (int k = 0; k < states(); ++k)
      add_product(sum, row.slopes[static_cast<std::size_t>(k)], column[static_cast<std::size_t>(k)]);
    if (by_points(row)) {
      if (whitened.empty()) whitened = whiten(column);
      NodeId rest = zero_;
      std::vector<NodeId> const bends = bent(row);
      for (std::size_t p = 0; p < points_.size(); ++p) add_product(rest, whitened[p], bends[p]);
      sum = graph_.add(sum, graph_.multiply(graph_.constant(0.5 / std::sqrt(spread_)), rest));
    }
    result.push_back(sum);
  }
  return result;
}

/// The v with L v = column, L the Cholesky factor of P; 0 where that has no column.
std::vector<NodeId> MomentPassage::whiten(std::vector<NodeId> const& column) {
  std::vector<NodeId> result;
  for (Point const& point : points()) {
    NodeId left = column[static_cast<std::size_t>(point.state)];
    for (std::size_t k = 0; k < result.size(); ++k) {
      NodeId const entry = points_[k].column[static_cast<std::size_t>(point.state)];
      if (!is_zero(entry) && !is_zero(result[k])) left = graph_.subtract(left, graph_.multiply(entry, result[k]));
    }
    result.push_back(is_zero(left) ? zero_ : graph_.select(point.positive, graph_.divide(left, point.root), zero_));
  }
  return result;
}

}  // namespace sysid
