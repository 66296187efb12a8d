// Thornton's step and Bierman's correction, written out entry by entry.
#include "program/moments/factored_covariance.hpp"

#include <algorithm>

namespace sysid {
namespace {

/// A variance below this, of a state that decays without noise, is none: one over it, and more so the derivative, would overflow.
constexpr double no_variance = 1e-140;

}  // namespace

NodeId FactoredCovariance::inverse(NodeId pivot, NodeId least) const {
  NodeId const positive = graph_.binary(Operation::less, least, pivot), one = graph_.constant(1);
  return graph_.select(positive, graph_.divide(one, graph_.select(positive, pivot, one)), zero_);
}

FactoredCovariance FactoredCovariance::of(Graph& graph, Symmetric covariance) {
  FactoredCovariance result(graph, std::move(covariance));
  Symmetric& entries = result.entries_;
  Symmetric const given = entries;
  NodeId const rounding = graph.constant(1e-14);
  for (int k = result.size() - 1; k >= 0; --k) {
    if (result.is_zero(entries(k, k))) continue;
    NodeId const least = k + 1 < result.size() ? graph.multiply(rounding, given(k, k)) : result.zero_;
    NodeId const inverse = result.inverse(entries(k, k), least);
    entries(k, k) = graph.select(graph.binary(Operation::less, least, entries(k, k)), entries(k, k), result.zero_);
    for (int i = 0; i < k; ++i)
      for (int j = 0; j <= i; ++j) {
        NodeId const share = result.product(result.product(entries(i, k), inverse), entries(j, k));
        if (!result.is_zero(share)) entries(i, j) = graph.subtract(entries(i, j), share);
      }
    for (int i = 0; i < k; ++i) entries(i, k) = result.product(entries(i, k), inverse);
  }
  return result;
}

NodeId FactoredCovariance::covariance(int i, int j) const {
  NodeId sum = zero_;
  for (int k = std::max(i, j); k < size(); ++k)
    if (NodeId const share = product(product(u(i, k), u(j, k)), d(k)); !is_zero(share)) sum = graph_.add(sum, share);
  return sum;
}

FactoredCovariance FactoredCovariance::moved(std::vector<NodeId> const& transition, std::vector<NodeId> const& noise,
                                             std::vector<NodeId> const& q) const {
  auto const n = static_cast<std::size_t>(size());
  std::size_t const columns = n + q.size();
  std::vector<NodeId> weights;
  for (int k = 0; k < size(); ++k) weights.push_back(d(k));
  weights.insert(weights.end(), q.begin(), q.end());
  std::vector<std::vector<NodeId>> rows;
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<NodeId> row(columns, zero_);
    for (int k = 0; k < size(); ++k)
      for (int l = 0; l <= k && !is_zero(d(k)); ++l)
        if (NodeId const share = product(transition[i * n + static_cast<std::size_t>(l)], u(l, k)); !is_zero(share))
          row[static_cast<std::size_t>(k)] = graph_.add(row[static_cast<std::size_t>(k)], share);
    for (std::size_t k = 0; k < q.size(); ++k)
      if (!is_zero(q[k])) row[n + k] = noise[i * q.size() + k];
    rows.push_back(std::move(row));
  }
  FactoredCovariance result(graph_, Symmetric(size(), zero_));
  for (std::size_t i = n; i-- > 0;) {
    std::vector<NodeId> weighted(columns, zero_);
    NodeId sum = zero_;
    for (std::size_t k = 0; k < columns; ++k) {
      weighted[k] = product(weights[k], rows[i][k]);
      if (!is_zero(weighted[k])) sum = graph_.add(sum, graph_.multiply(weighted[k], rows[i][k]));
    }
    result.entries_(static_cast<int>(i), static_cast<int>(i)) = sum;
    if (is_zero(sum)) continue;
    NodeId const inverse = result.inverse(sum, graph_.constant(no_variance));
    for (std::size_t j = 0; j < i; ++j) {
      NodeId with = zero_;
      for (std::size_t k = 0; k < columns; ++k)
        if (NodeId const share = product(weighted[k], rows[j][k]); !is_zero(share)) with = graph_.add(with, share);
      if (is_zero(with)) continue;
      NodeId const factor = graph_.multiply(with, inverse);
      result.entries_(static_cast<int>(i), static_cast<int>(j)) = factor;
      for (std::size_t k = 0; k < columns; ++k)
        if (!is_zero(rows[i][k])) rows[j][k] = graph_.subtract(rows[j][k], graph_.multiply(factor, rows[i][k]));
    }
  }
  return result;
}

/// With f = U'h and g = D f the variance of the sample is R + sum f_j g_j; its partial sums are alpha_j, all positive:
///   D_j <- D_j alpha_(j-1)/alpha_j,   U_ij <- U_ij - b_i f_j/alpha_(j-1),   b_i <- b_i + U_ij g_j,  b_j = g_j
/// and b is in the end the covariance of the states with the sample.                  Bierman 1977, p. 78
FactoredCovariance::Corrected FactoredCovariance::corrected(std::vector<NodeId> const& slopes, NodeId noise) const {
  Corrected result{noise, std::vector<NodeId>(static_cast<std::size_t>(size()), zero_), *this};
  std::vector<NodeId>& with = result.covariance;
  for (int j = 0; j < size(); ++j) {
    NodeId f = zero_;
    for (int i = 0; i <= j; ++i)
      if (NodeId const share = product(slopes[static_cast<std::size_t>(i)], u(i, j)); !is_zero(share)) f = graph_.add(f, share);
    NodeId const g = product(d(j), f);
    if (is_zero(g)) continue;
    NodeId const before = result.variance;
    result.variance = graph_.add(before, graph_.multiply(f, g));
    NodeId const kept = graph_.divide(before, result.variance);
    result.left.entries_(j, j) = graph_.multiply(d(j), kept);
    NodeId const factor = graph_.divide(f, before);
    for (int i = 0; i < j; ++i) {
      NodeId& b = with[static_cast<std::size_t>(i)];
      if (!is_zero(b)) result.left.entries_(j, i) = graph_.subtract(u(i, j), graph_.multiply(b, factor));
      if (NodeId const share = product(u(i, j), g); !is_zero(share)) b = graph_.add(b, share);
    }
    with[static_cast<std::size_t>(j)] = g;
  }
  return result;
}

}  // namespace sysid
