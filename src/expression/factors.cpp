// One walk down the products, with the exponent that stands over each.
#include "expression/factors.hpp"

#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

bool is_whole(double x) { return x == std::floor(x); }
bool is_even(double x) { return is_whole(x / 2); }

class Collector {
 public:
  explicit Collector(Graph& graph) : graph_(graph) {}

  void add(NodeId id, double exponent) {
    Node const node = graph_[id];
    switch (node.operation) {
      case Operation::constant:
        factors.constant *= elementary::pow(node.value, exponent);
        return;
      case Operation::negate:
        if (!is_whole(exponent)) break;
        if (!is_even(exponent)) factors.constant = -factors.constant;
        return add(node.a, exponent);
      case Operation::multiply:
      case Operation::divide:
        if (!is_whole(exponent)) break;
        add(node.a, exponent);
        return add(node.b, node.operation == Operation::multiply ? exponent : -exponent);
      case Operation::power:
        // (a^p)^q is a^(p q) where q is whole; with another q it may be |a|.
        if (auto const inner = graph_.constant_value(node.b); inner && is_whole(exponent)) return add(node.a, *inner * exponent);
        break;
      case Operation::absolute: {
        Factors const inside = factors_of(graph_, node.a);
        factors.constant *= elementary::pow(std::fabs(inside.constant), exponent);
        for (auto const& [base, power] : inside.powers) {
          double const total = power * exponent;
          bool const even = is_even(total) && is_whole(power);
          count(even ? base : graph_.unary(Operation::absolute, base), total);
        }
        return;
      }
      default:
        break;
    }
    count(id, exponent);
  }

  Factors factors;

 private:
  // |a|^2 becomes a^2 also where its two factors were met one after the other.
  void count(NodeId base, double exponent) {
    double& power = factors.powers[base];
    power += exponent;
    double const total = power;
    if (total == 0) factors.powers.erase(base);
    if (Node const node = graph_[base]; node.operation == Operation::absolute && total != 0 && is_even(total)) {
      factors.powers.erase(base);
      count(node.a, total);
    }
  }

  Graph& graph_;
};

}  // namespace

Factors factors_of(Graph& graph, NodeId root) {
  Collector collector(graph);
  collector.add(root, 1);
  return std::move(collector.factors);
}

}  // namespace sysid
