// The graph from its leaves up; shared parts become local variables.
#include "exchange/stan_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/text/number.hpp"
#include "expression/function.hpp"

namespace sysid {
namespace {

constexpr std::array same_name = {"exp",   "expm1", "log",  "log1p",  "log10",   "sin",     "cos",
                                  "tan",   "asin",  "acos", "atan",   "sinh",    "cosh",    "tanh",
                                  "atan2", "erf",   "erfc", "lgamma", "digamma", "gamma_p", "gamma_q"};

class Writer {
 public:
  Writer(Graph const& graph, std::span<NodeId const> roots, StanLeaves const& leaf_text)
      : graph_(graph), roots_(roots), leaf_text_(leaf_text), uses_(graph.size(), 0), names_(graph.size()) {}

  StanExpressions operator()() {
    std::vector<NodeId> const order = graph_.reachable(roots_);
    for (NodeId const id : order) {
      Node const& node = graph_[id];
      int const count = graph_.operand_count(id);
      for (int k = 0; k < count; ++k) ++uses_[k == 0 ? node.a : k == 1 ? node.b : node.c];
    }
    for (NodeId const id : roots_) ++uses_[id];
    StanExpressions out;
    for (NodeId const id : order) {
      if (graph_.operand_count(id) == 0 || uses_[id] < 2) continue;
      std::string const text = written(id);
      names_[id] = fmt::format("term_{}", ++locals_);
      out.declarations += fmt::format("    {} {} = {};\n", condition(id) ? "int" : "real", names_[id], text);
    }
    for (NodeId const id : roots_) out.texts.push_back(operand(id));
    return out;
  }

 private:
  bool condition(NodeId id) const {
    Operation const operation = graph_[id].operation;
    return operation == Operation::less || operation == Operation::less_equal || operation == Operation::equal ||
           operation == Operation::conjunction || operation == Operation::disjunction || operation == Operation::negation;
  }

  std::string operand(NodeId id) const { return names_[id].empty() ? written(id) : names_[id]; }

  std::string written(NodeId id) const {
    Node const& node = graph_[id];
    auto const infix = [&](char const* sign) { return fmt::format("({} {} {})", operand(node.a), sign, operand(node.b)); };
    auto const called = [&](std::string_view name) {
      return graph_.operand_count(id) == 1 ? fmt::format("{}({})", name, operand(node.a))
                                           : fmt::format("{}({}, {})", name, operand(node.a), operand(node.b));
    };
    switch (node.operation) {
      case Operation::constant:
        return stan_real(node.value);
      case Operation::leaf:
        return leaf_text_(id);
      case Operation::negate:
        return fmt::format("(-{})", operand(node.a));
      case Operation::add:
        return infix("+");
      case Operation::subtract:
        return infix("-");
      case Operation::multiply:
        return infix("*");
      case Operation::divide:
        return infix("/");
      case Operation::power:
        return called("pow");
      case Operation::fused:
        return fmt::format("({} * {} + {})", operand(node.a), operand(node.b), operand(node.c));
      case Operation::square_root:
        return called("sqrt");
      case Operation::absolute:
        return called("absolute_value");
      case Operation::sign:
        return called("sign_of");
      case Operation::minimum:
        return called("fmin");
      case Operation::maximum:
        return called("fmax");
      case Operation::floor:
        return called("floor");
      case Operation::less:
        return infix("<");
      case Operation::less_equal:
        return infix("<=");
      case Operation::equal:
        return infix("==");
      case Operation::conjunction:
        return infix("&&");
      case Operation::disjunction:
        return infix("||");
      case Operation::negation:
        return fmt::format("(!{})", operand(node.a));
      case Operation::select:
        return fmt::format("({} ? {} : {})", operand(node.a), operand(node.b), operand(node.c));
      case Operation::call:
        break;
    }
    return called(node.function->name);
  }

  Graph const& graph_;
  std::span<NodeId const> roots_;
  StanLeaves const& leaf_text_;
  std::vector<int> uses_;
  std::vector<std::string> names_;
  int locals_ = 0;
};

}  // namespace

std::string stan_real(double value) {
  if (std::isnan(value)) return "not_a_number()";
  if (std::isinf(value)) return value > 0 ? "positive_infinity()" : "negative_infinity()";
  std::string text = shortest(value);
  if (text.find_first_of(".e") == std::string::npos) text += ".0";
  return value < 0 ? "(" + text + ")" : text;
}

std::optional<std::string> lacking_in_stan(Graph const& graph, std::span<NodeId const> roots) {
  for (NodeId const id : graph.reachable(roots)) {
    Node const& node = graph[id];
    bool const here =
        node.operation != Operation::call || std::find(same_name.begin(), same_name.end(), node.function->name) != same_name.end();
    if (!here) return std::string(node.function->name);
  }
  return std::nullopt;
}

StanExpressions stan_expressions(Graph const& graph, std::span<NodeId const> roots, StanLeaves const& leaf_text) {
  return Writer(graph, roots, leaf_text)();
}

std::string_view stan_own_functions() {
  return R"(  real absolute_value(real x) {
    if (x < 0) return -x;
    return x;
  }
  real sign_of(real x) {
    if (x > 0) return 1;
    if (x < 0) return -1;
    return 0;
  }
)";
}

}  // namespace sysid
