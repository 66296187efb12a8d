// The covariance of random states as U D U': how it passes a step and a sample, as expressions.
#pragma once
#include <vector>

#include "expression/graph.hpp"
#include "program/moments/moment_passage.hpp"

namespace sysid {

/// U D U', U with ones on its diagonal and zeros below, D diagonal, packed as Symmetric: D at (i, i), entry (j, i) of U at (i, j),
/// j < i. Where an entry of D is zero its column of U is, too. All is written so that no entry of D is a difference.
class FactoredCovariance {
 public:
  FactoredCovariance(Graph& graph, Symmetric entries) : graph_(graph), zero_(graph.constant(0)), entries_(std::move(entries)) {}
  /// Of a covariance given as such, whose entries may be so singular that rounding decides.
  static FactoredCovariance of(Graph& graph, Symmetric covariance);

  Symmetric const& entries() const { return entries_; }
  /// Entry (i, j) of U D U'.
  NodeId covariance(int i, int j) const;

  /// Of F (U D U') F' + N diag(q) N': Gram and Schmidt with weights on the rows of (F U | N), from the last one on. transition: F
  /// [n x n], noise: N [n x columns], row by row.
  FactoredCovariance moved(std::vector<NodeId> const& transition, std::vector<NodeId> const& noise,
                           std::vector<NodeId> const& q) const;

  struct Corrected;
  /// By a sample with these slopes of its mean by the states and this variance of its noise.
  Corrected corrected(std::vector<NodeId> const& slopes, NodeId noise) const;

 private:
  int size() const { return entries_.size(); }
  NodeId d(int i) const { return entries_(i, i); }
  NodeId u(int i, int j) const { return i == j ? graph_.constant(1) : entries_(j, i); }  // i <= j
  bool is_zero(NodeId id) const { return graph_.is_constant(id, 0); }
  NodeId product(NodeId a, NodeId b) const { return is_zero(a) || is_zero(b) ? zero_ : graph_.multiply(a, b); }
  /// 1/pivot, 0 where that is not more than `least`.
  NodeId inverse(NodeId pivot, NodeId least) const;

  Graph& graph_;
  NodeId zero_;
  Symmetric entries_;
};

struct FactoredCovariance::Corrected {
  NodeId variance = 0;             // of the sample
  std::vector<NodeId> covariance;  // of the states with the sample
  FactoredCovariance left;
};

}  // namespace sysid
