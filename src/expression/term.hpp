// A node together with its graph, with the operators of arithmetic: formulas built in C++ read as they stand in the book.
// But where both sides of an operator make nodes, one has a name: C++ leaves open which is made first (graph.cpp).
#pragma once
#include "expression/graph.hpp"

namespace sysid {

struct Term {
  Term(Graph& in, NodeId node) : graph(&in), id(node) {}
  Term(Graph& in, double value) : graph(&in), id(in.constant(value)) {}

  Graph* graph;
  NodeId id;
};

inline Term operator-(Term a) { return {*a.graph, a.graph->negate(a.id)}; }
inline Term operator+(Term a, Term b) { return {*a.graph, a.graph->add(a.id, b.id)}; }
inline Term operator-(Term a, Term b) { return {*a.graph, a.graph->subtract(a.id, b.id)}; }
inline Term operator*(Term a, Term b) { return {*a.graph, a.graph->multiply(a.id, b.id)}; }
inline Term operator/(Term a, Term b) { return {*a.graph, a.graph->divide(a.id, b.id)}; }
inline Term operator+(Term a, double b) { return a + Term(*a.graph, b); }
inline Term operator-(Term a, double b) { return a - Term(*a.graph, b); }
inline Term operator*(Term a, double b) { return a * Term(*a.graph, b); }
inline Term operator/(Term a, double b) { return a / Term(*a.graph, b); }
inline Term operator+(double a, Term b) { return Term(*b.graph, a) + b; }
inline Term operator-(double a, Term b) { return Term(*b.graph, a) - b; }
inline Term operator*(double a, Term b) { return Term(*b.graph, a) * b; }
inline Term operator/(double a, Term b) { return Term(*b.graph, a) / b; }

inline Term pow(Term a, Term b) { return {*a.graph, a.graph->power(a.id, b.id)}; }
inline Term sqrt(Term a) { return {*a.graph, a.graph->unary(Operation::square_root, a.id)}; }
inline Term abs(Term a) { return {*a.graph, a.graph->unary(Operation::absolute, a.id)}; }
inline Term sign(Term a) { return {*a.graph, a.graph->unary(Operation::sign, a.id)}; }
inline Term floor(Term a) { return {*a.graph, a.graph->unary(Operation::floor, a.id)}; }
inline Term min(Term a, Term b) { return {*a.graph, a.graph->binary(Operation::minimum, a.id, b.id)}; }
inline Term max(Term a, Term b) { return {*a.graph, a.graph->binary(Operation::maximum, a.id, b.id)}; }
/// Conditions: 1 or 0.
inline Term less(Term a, Term b) { return {*a.graph, a.graph->binary(Operation::less, a.id, b.id)}; }
inline Term less(Term a, double b) { return less(a, Term(*a.graph, b)); }
inline Term less_equal(Term a, Term b) { return {*a.graph, a.graph->binary(Operation::less_equal, a.id, b.id)}; }
inline Term select(Term condition, Term then, Term otherwise) {
  return {*condition.graph, condition.graph->select(condition.id, then.id, otherwise.id)};
}

}  // namespace sysid
