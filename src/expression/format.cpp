// A graph as infix text in the language's own notation, for dumps and messages.
#include <fmt/format.h>

#include <cmath>

#include "core/text/diagnostic.hpp"
#include "expression/function.hpp"
#include "expression/graph.hpp"

namespace sysid {
namespace {

// Binding strength; an operand weaker than its place asks for stands in parentheses. A minus sign binds like a sum, so that
// no two operators stand side by side: (-a)*b, a + (-b).
enum Strength { conditional, alternative, conjunctive, negated, comparison, sum, product, exponent, atom };

struct Text {
  std::string text;
  Strength strength = atom;

  std::string at_least(Strength needed) const { return strength < needed ? fmt::format("({})", text) : text; }
};

// Text of a shared node is repeated at each use, which can grow exponentially: beyond this length a node is shown as dots.
constexpr std::size_t longest_text = 20'000;

Text infix(Text const& a, std::string_view symbol, Text const& b, Strength strength, Strength left, Strength right) {
  return {fmt::format("{}{}{}", a.at_least(left), symbol, b.at_least(right)), strength};
}

Text call_text(std::string_view name, Text const& a) { return {fmt::format("{}({})", name, a.text), atom}; }
Text call_text(std::string_view name, Text const& a, Text const& b) {
  return {fmt::format("{}({}, {})", name, a.text, b.text), atom};
}

Text number(double value) { return {fmt::format("{}", value), std::signbit(value) && !std::isnan(value) ? sum : atom}; }

Text operation_text(Node const& node, Text const& a, Text const& b, Text const& c) {
  switch (node.operation) {
    case Operation::negate:
      return {fmt::format("-{}", a.at_least(product)), sum};
    case Operation::add:
      return infix(a, " + ", b, sum, sum, product);
    case Operation::subtract:
      return infix(a, " - ", b, sum, sum, product);
    case Operation::multiply:
      return infix(a, "*", b, product, product, exponent);
    case Operation::divide:
      return infix(a, "/", b, product, product, exponent);
    case Operation::power:
      return infix(a, "^", b, exponent, atom, exponent);
    case Operation::fused:
      return {fmt::format("fma({}, {}, {})", a.text, b.text, c.text), atom};
    case Operation::square_root:
      return call_text("sqrt", a);
    case Operation::absolute:
      return call_text("abs", a);
    case Operation::sign:
      return call_text("sign", a);
    case Operation::floor:
      return call_text("floor", a);
    case Operation::minimum:
      return call_text("min", a, b);
    case Operation::maximum:
      return call_text("max", a, b);
    case Operation::less:
      return infix(a, " < ", b, comparison, sum, sum);
    case Operation::less_equal:
      return infix(a, " <= ", b, comparison, sum, sum);
    case Operation::equal:
      return infix(a, " == ", b, comparison, sum, sum);
    case Operation::conjunction:
      return infix(a, " and ", b, conjunctive, conjunctive, negated);
    case Operation::disjunction:
      return infix(a, " or ", b, alternative, alternative, conjunctive);
    case Operation::negation:
      return {fmt::format("not {}", a.at_least(negated)), negated};
    case Operation::select:
      return {fmt::format("if {} then {} else {}", a.at_least(alternative), b.text, c.text), conditional};
    case Operation::call:
      return node.function->arity == 1 ? call_text(node.function->name, a) : call_text(node.function->name, a, b);
    case Operation::constant:
    case Operation::leaf:
      break;
  }
  throw InternalError("an operation without a notation");
}

}  // namespace

std::string Graph::format(NodeId root, std::function<std::string(NodeId)> const& name_of) const {
  std::vector<NodeId> const order = reachable({&root, 1});
  std::vector<Text> texts(root + std::size_t{1});
  for (NodeId const id : order) {
    Node const& node = nodes_[id];
    if (node.operation == Operation::constant)
      texts[id] = number(node.value);
    else if (node.operation == Operation::leaf)
      texts[id] = {name_of(id), atom};
    else
      texts[id] = operation_text(node, texts[node.a], texts[node.b], texts[node.c]);
    if (texts[id].text.size() > longest_text) texts[id] = {"...", atom};
  }
  return texts[root].text;
}

}  // namespace sysid
