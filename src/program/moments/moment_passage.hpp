// How mean and covariance pass through functions of random states: by slopes at the mean, or by sigma points.
#pragma once
#include <algorithm>
#include <utility>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// How moments pass through what is not linear in the states.
enum class MomentRule {
  linearised,    // the extended Kalman filter: slopes at the mean
  sigma_points,  // the unscented Kalman filter: values at points that have the mean and covariance of the states
};

/// Symmetric, packed by rows of the lower triangle.
class Symmetric {
 public:
  Symmetric(int size, NodeId zero) : size_(size), entries_(static_cast<std::size_t>(size * (size + 1) / 2), zero) {}
  int size() const { return size_; }
  NodeId& operator()(int i, int j) { return entries_[place(i, j)]; }
  NodeId operator()(int i, int j) const { return entries_[place(i, j)]; }

 private:
  static std::size_t place(int i, int j) {
    auto const [row, column] = std::pair(std::max(i, j), std::min(i, j));
    return static_cast<std::size_t>(row * (row + 1) / 2 + column);
  }
  int size_;
  std::vector<NodeId> entries_;
};

/// A function of the states with its slopes.
struct MomentRow {
  NodeId value = 0;
  std::vector<NodeId> slopes;  // by each state, at the mean
  bool linear = true;          // the slopes read no state and, where points pass, nothing jumps
  std::vector<bool> read;      // by each state, where points pass through a jump: whether the value reads it; else empty
};

/// Of random states with means m and covariance P. Sigma points are m +- sqrt(c) times the columns of the Cholesky factor L of P, c
/// = max(n, 3) of n random states, weights 1/(2 c), and 1 - n/c at m (Julier & Uhlmann 2004, with no negative weight). What is
/// linear about the mean passes by P itself, so that points are needed only for the rest: they reproduce P where it has a Cholesky
/// factor, which at the stages of an integrator, near a known start, it need not.
class MomentPassage {
 public:
  /// means: leaves. covariance: expressions, or a constant zero where there is none; complete before anything passes. Both outlive
  /// it. first_column: the state whose column of L comes first, those after it next, then those before.
  MomentPassage(Graph& graph, std::vector<NodeId> const& means, Symmetric const& covariance, MomentRule rule, int first_column);

  MomentRow row(NodeId value) const;
  /// Whether what the row gives varies with state k, as far as the rule sees it.
  bool moves(MomentRow const& row, int k) const;
  bool linearises() const { return rule_ == MomentRule::linearised; }
  bool by_points(MomentRow const& row) const { return rule_ == MomentRule::sigma_points && !row.linear; }
  NodeId expectation(MomentRow const& row);
  /// cov(x_j, row)
  NodeId with_state(MomentRow const& row, int j);
  /// cov(a, b)
  NodeId between(MomentRow const& a, MomentRow const& b);
  /// var(row), of which with_state(row, j) is given for all j.
  NodeId variance(MomentRow const& row, std::vector<NodeId> const& with_states);
  /// A c of a column c in the range of P, one entry per row; A = cov(row, x) P^-1, by which P moves.
  std::vector<NodeId> moved(std::vector<MomentRow> const& rows, std::vector<NodeId> const& column);

  bool is_zero(NodeId id) const { return graph_.is_constant(id, 0); }
  /// to + a b; products with zero are no nodes.
  void add_product(NodeId& to, NodeId a, NodeId b) const {
    if (!is_zero(a) && !is_zero(b)) to = graph_.add(to, graph_.multiply(a, b));
  }

 private:
  struct Point {
    std::vector<NodeId> ahead, behind;  // the states at m + offset, m - offset
    std::vector<NodeId> offset;         // sqrt(c) times a column of L
    int state = 0;                      // of whose variance that column takes what is left
    std::vector<NodeId> column;         // of L
    NodeId positive = 0, root = 0;      // whether that is more than 0; its root
  };
  /// Values of a row at the points.
  struct Values {
    NodeId centre = 0, mean = 0;
    std::vector<NodeId> ahead, behind;
  };

  int states() const { return static_cast<int>(means_.size()); }
  std::vector<Point> const& points();
  NodeId at(NodeId value, std::vector<NodeId> const& states) const;
  Values values(NodeId value);
  std::vector<NodeId> bent(MomentRow const& row);
  std::vector<NodeId> whiten(std::vector<NodeId> const& column);
  NodeId weight() const { return graph_.constant(0.5 / spread_); }
  NodeId centre_weight() const { return graph_.constant(1 - static_cast<double>(points_.size()) / spread_); }

  Graph& graph_;
  std::vector<NodeId> const& means_;
  Symmetric const& covariance_;
  MomentRule rule_;
  int first_column_;
  NodeId zero_;
  std::vector<Point> points_;
  int spread_ = 3;  // c
};

}  // namespace sysid
