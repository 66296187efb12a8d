// What each operation is worth in numbers, and a pass that evaluates.
#include <cmath>
#include <limits>

#include "core/numeric/elementary.hpp"
#include "core/text/diagnostic.hpp"
#include "expression/function.hpp"
#include "expression/graph.hpp"

namespace sysid {
namespace {

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();

double condition(bool holds) { return holds ? 1.0 : 0.0; }
double compared(double a, double b, bool holds) { return a != a || b != b ? unknown : condition(holds); }

}  // namespace

double Graph::evaluate(NodeId root, std::function<double(NodeId)> const& value_of) const {
  return evaluate({&root, 1}, value_of).front();
}

std::vector<double> Graph::evaluate(std::span<NodeId const> roots, std::function<double(NodeId)> const& value_of) const {
  std::vector<NodeId> const order = reachable(roots);
  std::vector<double> values(order.empty() ? 0 : order.back() + std::size_t{1});
  for (NodeId const id : order) {
    Node const& node = nodes_[id];
    values[id] = node.operation == Operation::leaf ? value_of(id) : apply(node, values[node.a], values[node.b], values[node.c]);
  }
  std::vector<double> result;
  result.reserve(roots.size());
  for (NodeId const root : roots) result.push_back(values[root]);
  return result;
}

double apply(Node const& node, double a, double b, double c) {
  switch (node.operation) {
    case Operation::constant:
      return node.value;
    case Operation::leaf:
      return std::numeric_limits<double>::quiet_NaN();  // has a value only where it is read
    case Operation::negate:
      return -a;
    case Operation::add:
      return a + b;
    case Operation::subtract:
      return a - b;
    case Operation::multiply:
      return a * b;
    case Operation::divide:
      return a / b;
    case Operation::power:
      return elementary::pow(a, b);
    case Operation::fused:
      return std::fma(a, b, c);
    case Operation::square_root:
      return std::sqrt(a);
    case Operation::absolute:
      return std::fabs(a);
    case Operation::sign:
      return a != a ? unknown : condition(a > 0) - condition(a < 0);
    case Operation::minimum:
      return a != a || a < b ? a : b;
    case Operation::maximum:
      return a != a || a > b ? a : b;
    case Operation::floor:
      return std::floor(a);
    case Operation::less:
      return compared(a, b, a < b);
    case Operation::less_equal:
      return compared(a, b, a <= b);
    case Operation::equal:
      return compared(a, b, a == b);
    case Operation::conjunction:
      return a == 0 || b == 0 ? 0 : compared(a, b, true);
    case Operation::disjunction: {
      bool const holds = (a == a && a != 0) || (b == b && b != 0);
      return holds ? 1 : compared(a, b, false);
    }
    case Operation::negation:
      return compared(a, 0, a == 0);
    case Operation::select:
      return a != a ? a : a != 0 ? b : c;
    case Operation::call:
      return node.function->arity == 1 ? node.function->unary(a) : node.function->binary(a, b);
  }
  throw InternalError("an operation without a value");
}

}  // namespace sysid
