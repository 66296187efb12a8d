// Small matrices of expressions, written out entry by entry.
#pragma once
#include <utility>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// Entries that are zero are a constant zero, which is what products skip.
class Matrix {
 public:
  Matrix(int rows, int columns, NodeId zero)
      : rows_(rows), columns_(columns), entries_(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns), zero) {}
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  NodeId& operator()(int i, int j) { return entries_[static_cast<std::size_t>(i * columns_ + j)]; }
  NodeId operator()(int i, int j) const { return entries_[static_cast<std::size_t>(i * columns_ + j)]; }

 private:
  int rows_, columns_;
  std::vector<NodeId> entries_;
};

/// Sums and products of them; products with zero are no nodes.
class Matrices {
 public:
  explicit Matrices(Graph& graph) : graph_(graph), zero_(graph.constant(0)) {}

  Matrix zeros(int rows, int columns) const { return {rows, columns, zero_}; }
  bool is_zero(NodeId entry) const { return graph_.is_constant(entry, 0); }

  /// to + a b
  Matrix add_product(Matrix to, Matrix const& a, Matrix const& b) {
    for (int i = 0; i < a.rows(); ++i)
      for (int k = 0; k < a.columns(); ++k)
        for (int j = 0; j < b.columns() && !is_zero(a(i, k)); ++j) add_product(to(i, j), a(i, k), b(k, j));
    return to;
  }
  Matrix product(Matrix const& a, Matrix const& b) { return add_product(zeros(a.rows(), b.columns()), a, b); }

  /// to + factor a
  Matrix add_scaled(Matrix to, NodeId factor, Matrix const& a) {
    for (int i = 0; i < a.rows(); ++i)
      for (int j = 0; j < a.columns(); ++j) add_product(to(i, j), factor, a(i, j));
    return to;
  }
  Matrix add_scaled(Matrix to, double factor, Matrix const& a) { return add_scaled(std::move(to), graph_.constant(factor), a); }
  Matrix scaled(double factor, Matrix const& a) { return add_scaled(zeros(a.rows(), a.columns()), factor, a); }
  Matrix scaled(NodeId factor, Matrix const& a) { return add_scaled(zeros(a.rows(), a.columns()), factor, a); }

  Matrix add_to_diagonal(Matrix a, double value) {
    for (int i = 0; i < a.rows(); ++i) a(i, i) = graph_.add(a(i, i), graph_.constant(value));
    return a;
  }

  static Matrix columns_of(Matrix const& a, std::vector<int> const& columns, NodeId zero) {
    Matrix result(a.rows(), static_cast<int>(columns.size()), zero);
    for (int i = 0; i < a.rows(); ++i)
      for (int j = 0; j < result.columns(); ++j) result(i, j) = a(i, columns[static_cast<std::size_t>(j)]);
    return result;
  }

  void add_product(NodeId& to, NodeId a, NodeId b) {
    if (is_zero(a) || is_zero(b)) return;
    to = is_zero(to) ? graph_.multiply(a, b) : graph_.fused(a, b, to);
  }

 private:
  Graph& graph_;
  NodeId zero_;
};

}  // namespace sysid
