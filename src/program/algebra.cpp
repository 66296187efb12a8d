// Sums become lists of products, products lists of factors by binding time, and both are put together again in the cheapest order
// we know.
#include "program/algebra.hpp"

#include <algorithm>
#include <cmath>
#include <map>

namespace sysid {
namespace {

std::optional<int> integer_exponent(Graph const& graph, NodeId exponent) {
  std::optional<double> const value = graph.constant_value(exponent);
  if (!value || *value != std::floor(*value) || std::abs(*value) > largest_expanded_power || *value == 0) return std::nullopt;
  return static_cast<int>(*value);
}

bool is_sum(Operation operation) {
  return operation == Operation::add || operation == Operation::subtract || operation == Operation::negate;
}

}  // namespace

NodeId integer_power(Graph& graph, NodeId base, int exponent) {
  if (exponent < 0) return graph.divide(graph.constant(1), integer_power(graph, base, -exponent));
  if (exponent == 1) return base;
  if (exponent % 2 != 0) return graph.multiply(base, integer_power(graph, base, exponent - 1));
  NodeId const half = integer_power(graph, base, exponent / 2);
  return graph.multiply(half, half);
}

std::vector<NodeId> expand_powers(Graph& graph, std::span<NodeId const> roots) {
  std::unordered_map<NodeId, NodeId> image;
  for (NodeId const id : graph.reachable(roots)) {
    Node const node = graph[id];
    int const operands = operand_count(node);
    NodeId const a = operands > 0 ? image.at(node.a) : 0, b = operands > 1 ? image.at(node.b) : 0,
                 c = operands > 2 ? image.at(node.c) : 0;
    if (operands == 0) {
      image[id] = id;
    } else if (node.operation == Operation::power && integer_exponent(graph, b)) {
      image[id] = integer_power(graph, a, *integer_exponent(graph, b));
    } else if (node.operation == Operation::power && graph.is_constant(b, 0.5)) {
      image[id] = graph.unary(Operation::square_root, a);
    } else {
      image[id] = graph.rebuild(node, a, b, c);
    }
  }
  std::vector<NodeId> result;
  for (NodeId const root : roots) result.push_back(image.at(root));
  return result;
}

Algebra::Algebra(Graph& graph, std::span<NodeId const> roots) : graph_(graph), binding_(graph), one_(graph.constant(1)) {
  std::vector<NodeId> const nodes = graph.reachable(roots);
  uses_.assign(nodes.empty() ? 0 : nodes.back() + std::size_t{1}, 0);
  for (NodeId const id : nodes) {
    Node const& node = graph[id];
    NodeId const operands[] = {node.a, node.b, node.c};
    for (int i = 0; i < operand_count(node); ++i) ++uses_[operands[i]];
  }
  for (NodeId const root : roots) ++uses_[root];
  find_shared_powers(roots);
}

/// x^n and x^(n-1) with a common exponent known only per parameter: one power, the other a product.
void Algebra::find_shared_powers(std::span<NodeId const> roots) {
  std::map<std::pair<NodeId, NodeId>, std::vector<std::pair<double, NodeId>>>
      groups;  // (base, rest of exponent) -> (offset, power)
  for (NodeId const id : graph_.reachable(roots)) {
    Node const node = graph_[id];
    if (node.operation != Operation::power || !binding_.is_step(id)) continue;
    Node const exponent = graph_[node.b];
    NodeId rest = node.b;
    double offset = 0;
    if (exponent.operation == Operation::constant) {
      rest = one_;
      offset = exponent.value;
      if (2 * offset == std::floor(2 * offset)) continue;  // products and square roots serve these better
    } else if (exponent.operation == Operation::add && graph_.constant_value(exponent.b)) {
      rest = exponent.a;
      offset = *graph_.constant_value(exponent.b);
    } else if (exponent.operation == Operation::subtract && graph_.constant_value(exponent.b)) {
      rest = exponent.a;
      offset = -*graph_.constant_value(exponent.b);
    }
    groups[{node.a, rest}].push_back({offset, id});
  }
  for (auto& [key, powers] : groups) {
    std::sort(powers.begin(), powers.end());
    for (auto const& [offset, id] : powers) {
      double const difference = offset - powers.front().first;
      if (difference >= 1 && difference == std::floor(difference) && difference <= largest_expanded_power)
        shared_[id] = {powers.front().second, static_cast<int>(difference)};
    }
  }
}

NodeId Algebra::rewrite(NodeId id) {
  if (!binding_.is_step(id)) return id;
  if (auto const found = rewritten_.find(id); found != rewritten_.end()) return found->second;
  Node const node = graph_[id];
  NodeId result = id;
  switch (node.operation) {
    case Operation::leaf:
      break;
    case Operation::negate:
    case Operation::add:
    case Operation::subtract: {
      std::vector<Product> terms;
      collect_terms(id, false, terms, true);
      result = sum(std::move(terms));
      break;
    }
    case Operation::multiply:
    case Operation::divide: {
      Product collected = unit();
      collect(id, 1, collected, true);
      result = product(collected);
      break;
    }
    case Operation::power:
      result = rewrite_power(id);
      break;
    default: {
      int const operands = operand_count(node);
      NodeId const a = rewrite(node.a), b = operands > 1 ? rewrite(node.b) : 0, c = operands > 2 ? rewrite(node.c) : 0;
      result = graph_.rebuild(node, a, b, c);
    }
  }
  return rewritten_[id] = result;
}

NodeId Algebra::rewrite_power(NodeId id) {
  Node const node = graph_[id];
  if (integer_exponent(graph_, node.b)) {
    Product collected = unit();
    collect(id, 1, collected, true);
    return product(collected);
  }
  NodeId const base = rewrite(node.a);
  if (std::optional<double> const exponent = graph_.constant_value(node.b)) {
    // x^(k/2) = sqrt(x) x^((k-1)/2)
    double const twice = 2 * *exponent;
    if (twice == std::floor(twice) && std::abs(twice) <= 2 * largest_expanded_power) {
      int const whole = static_cast<int>(std::floor(*exponent));
      NodeId const root = graph_.unary(Operation::square_root, base);
      if (whole == 0) return root;
      if (whole == -1) return graph_.divide(one_, root);
      if (whole > 0) return graph_.multiply(root, integer_power(graph_, base, whole));
      return graph_.divide(one_, graph_.multiply(root, integer_power(graph_, base, -whole - 1)));
    }
  }
  if (auto const found = shared_.find(id); found != shared_.end()) {
    // At 0 the product may be 0 times infinity where the power is not; there the power of 0, known per parameter vector, is taken.
    auto const [lowest, difference] = found->second;
    NodeId const zero = graph_.constant(0);
    NodeId const risen = graph_.multiply(integer_power(graph_, base, difference), rewrite(lowest));
    return graph_.select(graph_.binary(Operation::equal, base, zero), graph_.power(zero, rewrite(node.b)), risen);
  }
  return graph_.power(base, rewrite(node.b));
}

// --- products ---

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
  if (!product.denominator.empty())
    return {graph_.divide(multiplied(factors), multiplied(factors_of(product.denominator))), one_, true};
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

// --- sums ---

void Algebra::collect_terms(NodeId id, bool negative, std::vector<Product>& terms, bool open) {
  Node const node = graph_[id];
  if (binding_.is_step(id) && is_sum(node.operation) && (open || may_open(id))) {
    collect_terms(node.a, node.operation == Operation::negate ? !negative : negative, terms, false);
    if (node.operation != Operation::negate)
      collect_terms(node.b, node.operation == Operation::subtract ? !negative : negative, terms, false);
    return;
  }
  Product term = unit();
  collect(id, 1, term, false);
  term.negative ^= negative;
  terms.push_back(std::move(term));
}

std::vector<Product> Algebra::expand(NodeId id) {
  std::vector<Product> terms;
  expand_below(id, unit(), terms);
  return terms;
}

void Algebra::expand_below(NodeId id, Product const& scale, std::vector<Product>& terms) {
  Node const node = graph_[id];
  Product scaled = scale;
  if (is_sum(node.operation)) {
    scaled.negative ^= node.operation == Operation::negate;
    expand_below(node.a, scaled, terms);
    if (node.operation == Operation::negate) return;
    scaled.negative ^= node.operation == Operation::subtract;
    return expand_below(node.b, scaled, terms);
  }
  auto const known = [this](NodeId operand) { return !binding_.is_step(operand); };
  if (node.operation == Operation::multiply && (known(node.a) || known(node.b))) {
    multiply_atom(scaled, known(node.a) ? node.a : node.b, 1);
    return expand_below(known(node.a) ? node.b : node.a, scaled, terms);
  }
  if (node.operation == Operation::divide && known(node.b)) {
    multiply_atom(scaled, node.b, -1);
    return expand_below(node.a, scaled, terms);
  }
  collect(id, 1, scaled, true);
  terms.push_back(std::move(scaled));
}

/// Horner: the base that most terms share is taken out of them, until no two share one.
///   k y + k3 y^3 = y (k + k3 y^2)
void Algebra::factor_out(std::vector<Product>& terms) {
  for (;;) {
    std::map<NodeId, std::pair<int, int>> counts;  // of terms; of exponents, which decide between equals
    for (Product const& term : terms) {
      if (!term.denominator.empty()) continue;
      for (Product::Factor const& factor : term.numerator) {
        ++counts[factor.base].first;
        counts[factor.base].second += factor.exponent;
      }
    }
    auto const fewer = [](auto const& a, auto const& b) { return a.second < b.second; };
    auto const best = std::max_element(counts.begin(), counts.end(), fewer);
    if (best == counts.end() || best->second.first < 2) return;
    NodeId const base = best->first;

    auto const find = [base](Product& term) {
      return std::find_if(term.numerator.begin(), term.numerator.end(), [base](auto const& factor) { return factor.base == base; });
    };
    std::vector<Product> with, without;
    int lowest = largest_expanded_power;
    for (Product& term : terms) {
      auto const factor = term.denominator.empty() ? find(term) : term.numerator.end();
      if (factor != term.numerator.end()) {
        lowest = std::min(lowest, factor->exponent);
        with.push_back(std::move(term));
      } else {
        without.push_back(std::move(term));
      }
    }
    for (Product& term : with) {
      auto const factor = find(term);
      factor->exponent -= lowest;
      if (factor->exponent == 0) term.numerator.erase(factor);
    }
    // A sign that all terms share stays outside.
    bool const negative = std::all_of(with.begin(), with.end(), [](Product const& term) { return term.negative; });
    if (negative)
      for (Product& term : with) term.negative = false;
    NodeId rest = sum(std::move(with));
    Product taken = unit();
    taken.negative = negative;
    if (graph_[rest].operation == Operation::negate) {
      taken.negative = !taken.negative;
      rest = graph_[rest].a;
    }
    multiply_factor(taken.numerator, base, lowest);
    if (binding_.is_step(rest))
      multiply_factor(taken.numerator, rest, 1);
    else
      multiply_atom(taken, rest, 1);
    terms = std::move(without);
    if (!graph_.is_constant(taken.parameter, 0)) terms.push_back(std::move(taken));
  }
}

NodeId Algebra::sum(std::vector<Product> terms) {
  // What is known early is summed early.
  NodeId const zero = graph_.constant(0);
  NodeId parameter = zero, data = zero;
  std::vector<Product> later;
  for (Product& term : terms) {
    bool const known = term.numerator.empty() && term.denominator.empty();
    if (!known || (term.data != one_ && binding_(term.parameter) == Binding::parameter)) {
      later.push_back(std::move(term));
      continue;
    }
    NodeId& part = term.data == one_ ? parameter : data;
    NodeId const value = graph_.multiply(term.parameter, term.data);
    part = term.negative ? graph_.subtract(part, value) : graph_.add(part, value);
  }
  if (graph_.constant_value(parameter)) {
    data = graph_.add(data, parameter);
    parameter = zero;
  }
  if (graph_.constant_value(data) && parameter != zero) {
    parameter = graph_.add(parameter, data);
    data = zero;
  }
  factor_out(later);
  for (NodeId const known : {parameter, data})
    if (known != zero) later.push_back(single(known));
  if (later.empty()) return zero;

  struct Term {
    Pair pair;
    bool negative;
    int depth;
  };
  std::vector<Term> ordered;
  for (Product const& term : later) {
    Pair const pair = split(term);
    ordered.push_back({pair, term.negative, std::max(depth(pair.a), pair.single ? 0 : depth(pair.b))});
  }
  std::stable_sort(ordered.begin(), ordered.end(), [](Term const& a, Term const& b) { return a.depth < b.depth; });
  // The chain begins with a term that needs no multiplication, if there is one, positive if possible; the latest known ends it.
  auto first = std::find_if(ordered.begin(), ordered.end(), [](Term const& term) { return term.pair.single && !term.negative; });
  if (first == ordered.end())
    first = std::find_if(ordered.begin(), ordered.end(), [](Term const& term) { return term.pair.single; });
  if (first == ordered.end()) first = std::find_if(ordered.begin(), ordered.end(), [](Term const& term) { return !term.negative; });
  bool const all_negative = first == ordered.end();
  if (all_negative) {
    first = ordered.begin();
    for (Term& term : ordered) term.negative = false;
  }
  std::rotate(ordered.begin(), first, first + 1);

  NodeId result = zero;
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    auto const& [pair, negative, depth] = ordered[i];
    if (i == 0) {
      NodeId const magnitude = pair.single ? pair.a : graph_.multiply(pair.a, pair.b);
      result = negative ? graph_.negate(magnitude) : magnitude;
    } else if (pair.single) {
      result = negative ? graph_.subtract(result, pair.a) : graph_.add(result, pair.a);
    } else {
      result = graph_.fused(negative ? graph_.negate(pair.a) : pair.a, pair.b, result);
    }
  }
  return all_negative ? graph_.negate(result) : result;
}

}  // namespace sysid
