// Rewriting of expressions before they are emitted: products for integer powers, Horner's form, fused multiply-adds, and everything
// that is known early gathered so that it is computed early. Exact in real arithmetic; a few ulp in floating point.
#pragma once
#include <optional>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "expression/graph.hpp"
#include "program/binding.hpp"

namespace sysid {

/// Only what never costs accuracy: x^n for integer |n| <= 16 as products, x^(1/2) as a square root.
std::vector<NodeId> expand_powers(Graph& graph, std::span<NodeId const> roots);

/// base^exponent by squaring, 1 <= |exponent|.
NodeId integer_power(Graph& graph, NodeId base, int exponent);
/// The exponent as an integer in [-16, 16], 0 excluded, if it is one.
std::optional<int> integer_exponent(Graph const& graph, NodeId exponent);
/// The largest |exponent| that is expanded into products.
constexpr int largest_expanded_power = 16;

/// A product sorted by binding time:  sign * parameter * data * prod(numerator) / prod(denominator).
struct Product {
  struct Factor {
    NodeId base;
    int exponent;  // > 0
  };
  bool negative = false;
  NodeId parameter = 0;                        // known once per parameter vector, constants included
  NodeId data = 0;                             // known once per data set
  std::vector<Factor> numerator, denominator;  // known at the step only
};

/// Rewrites the step-level parts of expressions; what is known earlier is left alone and counts as an atom.
class Algebra {
 public:
  /// roots: all expressions that will be rewritten; sub-expressions they share stay shared.
  Algebra(Graph& graph, std::span<NodeId const> roots);

  NodeId rewrite(NodeId id);
  /// `id` as a sum of products, sums under constant and per-parameter factors multiplied out; as one where that would make more
  /// than a thousand (sums that share their addends make twice as many with each step).
  std::vector<Product> expand(NodeId id);
  NodeId sum(std::vector<Product> terms);
  NodeId product(Product const& product);
  /// One factor, known early or at the step.
  Product single(NodeId id);

  BindingTimes& binding() { return binding_; }

 private:
  struct Shared {
    NodeId lowest;  // the power of the same base with the lowest exponent
    int difference;
  };

  Product unit();
  bool may_open(NodeId id) const { return id >= uses_.size() || uses_[id] <= 1; }
  void collect(NodeId id, int exponent, Product& into, bool open);
  void collect_terms(NodeId id, bool negative, std::vector<Product>& terms, bool open);
  double count_terms(NodeId id, std::unordered_map<NodeId, double>& counts);
  void expand_below(NodeId id, Product const& scale, std::vector<Product>& terms);
  void multiply_atom(Product& into, NodeId atom, int exponent);
  void multiply_factor(std::vector<Product::Factor>& factors, NodeId base, int exponent);
  void multiply(Product& into, Product const& by);
  NodeId rewrite_power(NodeId id);
  void factor_out(std::vector<Product>& terms);
  struct Pair {
    NodeId a, b;
    bool single;  // only a
  };
  Pair split(Product const& product);
  int rank(NodeId factor);
  NodeId multiplied(std::vector<NodeId> factors);
  std::vector<NodeId> factors_of(std::vector<Product::Factor> const& factors);
  int depth(NodeId id);
  void find_shared_powers(std::span<NodeId const> roots);

  Graph& graph_;
  BindingTimes binding_;
  NodeId one_;
  std::vector<int> uses_;  // of the nodes below the roots, as they were given
  std::unordered_map<NodeId, NodeId> rewritten_;
  std::unordered_map<NodeId, Shared> shared_;
  std::unordered_set<NodeId> waiting_;  // rewritten nodes that have several users
  std::vector<int> depth_;
};

}  // namespace sysid
