// Sums: expressions taken apart into products, common factors taken out, and put together as a chain of fused multiply-adds.
#include <algorithm>
#include <map>
#include <unordered_map>

#include "program/algebra.hpp"

namespace sysid {
namespace {

constexpr double most_terms = 1000;

bool is_sum(Operation operation) {
  return operation == Operation::add || operation == Operation::subtract || operation == Operation::negate;
}

}  // namespace

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
  std::unordered_map<NodeId, double> counts;
  if (count_terms(id, counts) > most_terms) {
    Product whole = unit();
    collect(id, 1, whole, true);
    return {whole};
  }
  std::vector<Product> terms;
  expand_below(id, unit(), terms);
  return terms;
}

/// How many terms `expand_below` would make.
double Algebra::count_terms(NodeId id, std::unordered_map<NodeId, double>& counts) {
  if (auto const counted = counts.find(id); counted != counts.end()) return counted->second;
  Node const& node = graph_[id];
  double count = 1;
  if (is_sum(node.operation))
    count = count_terms(node.a, counts) + (node.operation == Operation::negate ? 0 : count_terms(node.b, counts));
  else if (node.operation == Operation::multiply && !binding_.is_step(node.a))
    count = count_terms(node.b, counts);
  else if ((node.operation == Operation::multiply || node.operation == Operation::divide) && !binding_.is_step(node.b))
    count = count_terms(node.a, counts);
  return counts[id] = count;
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
