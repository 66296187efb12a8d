// Products: expressions taken apart into factors by binding time, and put together in the order that suits the accumulator.
#include <algorithm>

#include "program/algebra.hpp"

namespace sysid {

Product Algebra::unit() { return {.negative = false, .parameter = one_, .data = one_, .numerator = {}, .denominator = {}}; }

Product Algebra::single(NodeId id) {
  Product result = unit();
  if (binding_.is_step(id))
    result.numerator.push_back({id, 1});
  else
    multiply_atom(result, id, 1);
  return result;
}

void Algebra::multiply_atom(Product& into, NodeId atom, int exponent) {
  NodeId& part = binding_(atom) == Binding::data ? into.data : into.parameter;
  if (std::optional<double> const value = graph_.constant_value(atom); value && *value < 0) {
    into.negative ^= exponent % 2 != 0;
    atom = graph_.constant(-*value);
  }
  NodeId const power = integer_power(graph_, atom, std::abs(exponent));
  part = exponent > 0 ? graph_.multiply(part, power) : graph_.divide(part, power);
}

void Algebra::multiply_factor(std::vector<Product::Factor>& factors, NodeId base, int exponent) {
  // |x|^2 = x^2: an even power needs no absolute value, and |x|^3 = |x| x^2.
  for (Product::Factor& factor : factors) {
    if (factor.base != base) continue;
    factor.exponent += exponent;
    exponent = factor.exponent;
    if (graph_[base].operation != Operation::absolute || exponent < 2) return;
    factor.exponent = exponent % 2;
    exponent -= exponent % 2;
    std::erase_if(factors, [](Product::Factor const& each) { return each.exponent == 0; });
    return multiply_factor(factors, graph_[base].a, exponent);
  }
  if (graph_[base].operation == Operation::absolute && exponent >= 2) {
    if (exponent % 2 != 0) factors.push_back({base, 1});
    return multiply_factor(factors, graph_[base].a, exponent - exponent % 2);
  }
  factors.push_back({base, exponent});
}

void Algebra::multiply(Product& into, Product const& by) {
  into.negative ^= by.negative;
  into.parameter = graph_.multiply(into.parameter, by.parameter);
  into.data = graph_.multiply(into.data, by.data);
  for (Product::Factor const& factor : by.numerator) multiply_factor(into.numerator, factor.base, factor.exponent);
  for (Product::Factor const& factor : by.denominator) multiply_factor(into.denominator, factor.base, factor.exponent);
}

/// into *= id^exponent. open: `id` itself may be taken apart (it has no other user, or is the expression being rewritten).
void Algebra::collect(NodeId id, int exponent, Product& into, bool open) {
  if (!binding_.is_step(id)) return multiply_atom(into, id, exponent);
  Node const node = graph_[id];
  // A power is always taken apart: hash-consing finds the shared squares again.
  if (open || may_open(id) || node.operation == Operation::power) {
    switch (node.operation) {
      case Operation::negate:
        into.negative ^= exponent % 2 != 0;
        return collect(node.a, exponent, into, false);
      case Operation::multiply:
      case Operation::divide:
        if (exponent == 1 || exponent == -1) {
          collect(node.a, exponent, into, false);
          return collect(node.b, node.operation == Operation::multiply ? exponent : -exponent, into, false);
        } else {
          // (k x y)^n: what is known early comes out, the rest is raised as one.
          Product inner = unit();
          collect(id, 1, inner, true);
          into.negative ^= inner.negative && exponent % 2 != 0;
          multiply_atom(into, inner.parameter, exponent);
          multiply_atom(into, inner.data, exponent);
          inner.parameter = inner.data = one_;
          inner.negative = false;
          if (inner.numerator.empty() && inner.denominator.empty()) return;
          bool const single = inner.denominator.empty() && inner.numerator.size() == 1;
          NodeId const base = single ? inner.numerator.front().base : product(inner);
          int const total = std::abs(exponent) * (single ? inner.numerator.front().exponent : 1);
          return multiply_factor(exponent > 0 ? into.numerator : into.denominator, base, total);
        }
      case Operation::power:
        if (std::optional<int> const inner = integer_exponent(graph_, node.b);
            inner && std::abs(*inner * exponent) <= largest_expanded_power)
          return collect(node.a, *inner * exponent, into, false);
        break;
      default:
        break;
    }
  }
  NodeId base = rewrite(id);
  if (!may_open(id)) waiting_.insert(base);
  if (!binding_.is_step(base)) return multiply_atom(into, base, exponent);  // algebra may find it constant after all
  if (graph_[base].operation == Operation::negate) {
    into.negative ^= exponent % 2 != 0;
    base = graph_[base].a;
  }
  multiply_factor(exponent > 0 ? into.numerator : into.denominator, base, std::abs(exponent));
}

int Algebra::depth(NodeId id) {
  for (std::size_t i = depth_.size(); i <= id; ++i) {
    Node const& node = graph_[static_cast<NodeId>(i)];
    NodeId const operands[] = {node.a, node.b, node.c};
    int deepest = 0;
    for (int k = 0; k < operand_count(node); ++k) deepest = std::max(deepest, depth_[operands[k]]);
    depth_.push_back(binding_.is_step(static_cast<NodeId>(i)) ? deepest + 1 : 0);
  }
  return depth_[id];
}

/// Order of factors: those that wait in registers (states, and values with several users) by number, so that equal products meet;
/// then what is known early; then those computed for this product alone.
int Algebra::rank(NodeId factor) {
  if (!binding_.is_step(factor)) return 1;
  return graph_[factor].operation == Operation::leaf || waiting_.contains(factor) ? 0 : 2 + depth(factor);
}

/// The product of the factors. One that must be computed goes ahead of several that need not be, so that the product stays in the
/// accumulator all along.
NodeId Algebra::multiplied(std::vector<NodeId> factors) {
  if (factors.empty()) return one_;
  std::sort(factors.begin(), factors.end(), [this](NodeId a, NodeId b) { return std::pair(rank(a), a) < std::pair(rank(b), b); });
  auto const computed = std::find_if(factors.begin(), factors.end(), [this](NodeId factor) { return rank(factor) > 1; });
  if (computed - factors.begin() > 1 && computed != factors.end()) std::rotate(factors.begin(), computed, computed + 1);
  NodeId result = factors.front();
  for (std::size_t i = 1; i < factors.size(); ++i) result = graph_.multiply(result, factors[i]);
  return result;
}

/// Factors as nodes: powers as products, |a| |b| as |a b|.
std::vector<NodeId> Algebra::factors_of(std::vector<Product::Factor> const& factors) {
  std::vector<NodeId> result, magnitudes;
  for (Product::Factor const& factor : factors) {
    bool const magnitude = graph_[factor.base].operation == Operation::absolute && factor.exponent == 1;
    if (magnitude)
      magnitudes.push_back(graph_[factor.base].a);
    else
      result.push_back(integer_power(graph_, factor.base, factor.exponent));
  }
  if (!magnitudes.empty()) result.push_back(graph_.unary(Operation::absolute, multiplied(magnitudes)));
  return result;
}

/// |product| as a * b, for a fused multiply-add; b is the last factor in the order above.
Algebra::Pair Algebra::split(Product const& product) {
  std::vector<NodeId> factors = factors_of(product.numerator);
  if (product.parameter != one_) factors.push_back(product.parameter);
  if (product.data != one_) factors.push_back(product.data);
  if (!product.denominator.empty()) {
    NodeId const below = multiplied(factors_of(product.denominator));
    return {graph_.divide(multiplied(factors), below), one_, true};
  }
  if (factors.size() == 1 && product.numerator.size() == 1 && product.numerator.front().exponent > 1) {
    auto const [base, exponent] = product.numerator.front();
    int const half = exponent % 2 == 0 ? exponent / 2 : exponent - 1;
    return {integer_power(graph_, base, exponent - half), integer_power(graph_, base, half), false};
  }
  if (factors.size() < 2) return {multiplied(factors), one_, true};
  auto const last = std::max_element(factors.begin(), factors.end(),
                                     [this](NodeId a, NodeId b) { return std::pair(rank(a), a) < std::pair(rank(b), b); });
  NodeId const b = *last;
  factors.erase(last);
  return {multiplied(factors), b, false};
}

NodeId Algebra::product(Product const& product) {
  Pair const pair = split(product);
  NodeId const magnitude = pair.single ? pair.a : graph_.multiply(pair.a, pair.b);
  return product.negative ? graph_.negate(magnitude) : magnitude;
}

}  // namespace sysid
