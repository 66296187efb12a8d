// Determines signs in one pass from the leaves up.
#include "check/expression/non_negative.hpp"

#include <array>
#include <cmath>
#include <map>
#include <string_view>

#include "expression/function.hpp"

namespace sysid {
namespace {

constexpr std::array<std::string_view, 5> never_negative{"exp", "cosh", "erfc", "gamma_p", "gamma_q"};

bool is_even(Graph const& graph, NodeId exponent) {
  auto const value = graph.constant_value(exponent);
  return value && std::fmod(*value, 2) == 0;
}

}  // namespace

bool non_negative(Graph const& graph, NodeId root) {
  std::map<NodeId, bool> good;
  for (NodeId const id : graph.reachable({&root, 1})) {
    Node const& node = graph[id];
    auto const a = [&] { return good.at(node.a); };
    auto const b = [&] { return good.at(node.b); };
    bool result = false;
    switch (node.operation) {
      case Operation::constant:
        result = node.value >= 0;
        break;
      case Operation::absolute:
      case Operation::square_root:
      case Operation::less:
      case Operation::less_equal:
      case Operation::equal:
      case Operation::conjunction:
      case Operation::disjunction:
      case Operation::negation:
        result = true;
        break;
      case Operation::add:
      case Operation::divide:
      case Operation::minimum:
        result = a() && b();
        break;
      case Operation::multiply:
        result = node.a == node.b || (a() && b());
        break;
      case Operation::maximum:
        result = a() || b();
        break;
      case Operation::power:
        result = a() || is_even(graph, node.b);
        break;
      case Operation::fused:
        result = (node.a == node.b || (a() && b())) && good.at(node.c);
        break;
      case Operation::sign:
      case Operation::floor:
        result = a();
        break;
      case Operation::select:
        result = b() && good.at(node.c);
        break;
      case Operation::call: {
        for (std::string_view const name : never_negative) result = result || node.function->name == name;
        break;
      }
      case Operation::leaf:
      case Operation::negate:
      case Operation::subtract:
        break;
    }
    good[id] = result;
  }
  return good.at(root);
}

}  // namespace sysid
