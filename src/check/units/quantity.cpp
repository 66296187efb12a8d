// The algebra of expressions with units: one rule per operation. Literals take the unit that they need.
#include "check/units/quantity.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "check/units/units.hpp"

namespace sysid {
namespace {

using Kind = Typed::Kind;

Typed of_unknown_unit(NodeId node, Span span) {
  Typed result;
  result.node = node;
  result.span = span;
  return result;
}

Span cover_all(std::span<Typed const> operands) {
  Span span = operands.front().span;
  for (Typed const& operand : operands) span = cover(span, operand.span);
  return span;
}

}  // namespace

Typed literal(Graph& graph, double value, Span span) { return {graph.constant(value), Kind::literal, {}, span}; }

Typed tagged(Graph& graph, double value, Unit const& unit, Span span) {
  return {graph.constant(value * unit.scale), Kind::known, unit, span};
}

Typed with_unit(NodeId node, std::optional<Unit> const& unit, Span span) {
  return {node, unit ? Kind::known : Kind::unknown, unit.value_or(Unit{}), span};
}

namespace {

// A result of wrong operands is wrong, whatever else is known of it.
Typed unless_wrong(Typed result, std::span<Typed const> operands) {
  if (std::any_of(operands.begin(), operands.end(), [](Typed const& t) { return t.kind == Kind::wrong; }))
    result.kind = Kind::wrong;
  return result;
}
Typed unless_wrong(Typed result, Typed const& a, Typed const& b) {
  Typed const operands[] = {a, b};
  return unless_wrong(std::move(result), operands);
}

}  // namespace

NodeId adapt(Graph& graph, Typed const& typed, std::optional<Unit> const& unit) {
  if (!unit) return typed.node;
  if (typed.kind == Kind::literal) return graph.multiply(graph.constant(unit->scale), typed.node);
  if (typed.kind == Kind::known && typed.unit.offset != unit->offset && typed.unit.dimension == unit->dimension)
    return graph.add(typed.node, graph.constant(typed.unit.offset - unit->offset));
  return typed.node;
}

std::optional<Unit> unify(Graph& graph, std::span<Typed> operands) {
  auto const known = std::find_if(operands.begin(), operands.end(), [](Typed const& t) { return t.kind == Kind::known; });
  if (known == operands.end()) return std::nullopt;
  Unit unit = known->unit;
  // A number is converted to the zero point of what is none.
  if (graph.constant_value(known->node))
    for (Typed const& operand : operands)
      if (operand.kind == Kind::known && operand.unit.offset != unit.offset && !graph.constant_value(operand.node)) {
        unit = operand.unit;
        break;
      }
  // Beside a pure number a bare number is one: 1 + a/L is not 1 mm/m more than a/L. Beside a product it counts in SI.
  if (std::any_of(operands.begin(), operands.end(), [](Typed const& t) { return t.kind == Kind::literal; })) {
    if (unit.dimensionless()) {
      unit.scale = 1;
      unit.text.clear();
    }
    unit = named_or_coherent(std::move(unit));
  }
  for (Typed& operand : operands) operand.node = adapt(graph, operand, unit);
  return unit;
}

namespace {

// How many times pi is a factor of a bare number: 1 in 2*pi, -1 in 1/(2*pi), 2 in 4*pi^2; 0 without any.
int powers_of_pi(Graph const& graph, Typed const& factor) {
  auto const value = graph.constant_value(factor.node);
  if (!value || *value == 0) return 0;
  // As people write it who do not know `pi`: 3.1416, 6.28, 39.48.
  constexpr double two_pi = 2 * std::numbers::pi, rounded = 1e-3;
  for (auto const& [number, power] :
       {std::pair{two_pi / 2, 1}, {two_pi, 1}, {2 * two_pi, 1}, {two_pi * two_pi, 2}, {1 / two_pi, -1}})
    if (std::fabs(std::fabs(*value) / number - 1) < rounded) return power;
  double rest = *value;
  for (int const power : {1, 2}) {
    rest /= std::numbers::pi;
    if (auto const fraction = to_rational(rest); fraction && fraction->numerator != 0) return power;
  }
  rest = *value;
  for (int const power : {-1, -2}) {
    rest *= std::numbers::pi;
    if (auto const fraction = to_rational(rest); fraction && fraction->numerator != 0) return power;
  }
  return 0;
}

bool is_rate(Unit const& unit) {
  Dimension rate{};
  rate[2] = {-1, 1};
  return unit.dimension == rate;
}

// 2*pi makes radians of cycles, 1/(2*pi) cycles of radians. A rate in neither becomes what such a factor is meant to make of it.
Unit turned(Unit unit, int powers) {
  for (; powers > 0; --powers) {
    bool const plain = is_rate(unit) && unit.hertz.numerator == 0 && unit.radian.numerator == 0;
    if (unit.hertz.numerator <= 0 && !plain) break;
    if (!plain) unit.hertz = unit.hertz - Rational{1, 1};
    unit.radian = unit.radian + Rational{1, 1};
    unit.text.clear();
  }
  for (; powers < 0; ++powers) {
    bool const plain = is_rate(unit) && unit.hertz.numerator == 0 && unit.radian.numerator == 0;
    if (unit.radian.numerator <= 0 && !plain) break;
    if (!plain) unit.radian = unit.radian - Rational{1, 1};
    unit.hertz = unit.hertz + Rational{1, 1};
    unit.text.clear();
  }
  return unit;
}

int turns_of(Graph const& graph, Typed const& factor) {
  return factor.kind == Kind::literal ? powers_of_pi(graph, factor) : factor.turns;
}

// The root of 1/s^2, as in sqrt(k/m), is an angular frequency.
Unit root(Unit const& unit) {
  Unit result = power(unit, {1, 2});
  if (is_rate(result) && result.hertz.numerator == 0 && result.radian.numerator == 0) result.radian = {1, 1};
  return result;
}

// A ratio of like quantities is a pure number, whatever the scales they were declared in.
Unit pure(Unit unit) {
  if (unit.dimensionless() && unit.text.empty()) unit.scale = 1;
  return unit;
}

// The kind of a result whose operands share one unit.
Typed shared(NodeId node, std::span<Typed const> operands, std::optional<Unit> const& unit) {
  Typed result = of_unknown_unit(node, cover_all(operands));
  if (unit) {
    result.kind = Kind::known;
    result.unit = *unit;
  } else if (std::all_of(operands.begin(), operands.end(), [](Typed const& t) { return t.kind == Kind::literal; })) {
    result.kind = Kind::literal;
  }
  return unless_wrong(std::move(result), operands);
}

}  // namespace

Typed with_own_unit(Typed typed) {
  if (typed.kind == Kind::known) typed.unit = turned(std::move(typed.unit), typed.turns);
  typed.turns = 0;
  return typed;
}

Typed add(Graph& graph, Typed a, Typed b, bool subtract) {
  Typed operands[] = {with_own_unit(std::move(a)), with_own_unit(std::move(b))};
  auto const has_zero = [](Typed const& t) { return t.kind == Kind::known && t.unit.offset != 0; };
  bool const both = has_zero(operands[0]) && has_zero(operands[1]);
  // A temperature and a difference of temperatures: neither has a zero point to convert to the other's.
  bool const one = !both && (has_zero(operands[0]) || has_zero(operands[1])) && operands[0].kind == operands[1].kind;
  std::optional<Unit> unit;
  if (one)
    unit = has_zero(operands[0]) ? operands[0].unit : operands[1].unit;
  else
    unit = unify(graph, operands);
  NodeId const node = subtract ? graph.subtract(operands[0].node, operands[1].node) : graph.add(operands[0].node, operands[1].node);
  Typed result = shared(node, operands, unit);
  if (both && subtract) result.unit = difference(result.unit);
  return result;
}

Typed multiply(Graph& graph, Typed const& a, Typed const& b) {
  Typed result = of_unknown_unit(graph.multiply(a.node, b.node), cover(a.span, b.span));
  if (a.kind == Kind::literal && b.kind == Kind::literal) {
    result.kind = Kind::literal;
  } else if (a.kind != Kind::unknown && b.kind != Kind::unknown) {
    result.kind = Kind::known;
    result.unit = a.kind == Kind::literal ? b.unit : b.kind == Kind::literal ? a.unit : pure(sysid::multiply(a.unit, b.unit));
    result.turns = turns_of(graph, a) + turns_of(graph, b);
  }
  return unless_wrong(std::move(result), a, b);
}

Typed divide(Graph& graph, Typed const& a, Typed const& b) {
  Typed result = of_unknown_unit(graph.divide(a.node, b.node), cover(a.span, b.span));
  if (a.kind == Kind::literal && b.kind == Kind::literal) {
    result.kind = Kind::literal;
  } else if (a.kind != Kind::unknown && b.kind != Kind::unknown) {
    result.kind = Kind::known;
    Unit const one;
    result.unit = pure(sysid::divide(a.kind == Kind::literal ? one : a.unit, b.kind == Kind::literal ? one : b.unit));
    result.turns = turns_of(graph, a) - turns_of(graph, b);
  }
  return unless_wrong(std::move(result), a, b);
}

Typed power(Graph& graph, Typed const& a, Typed const& b) {
  Typed result = of_unknown_unit(graph.power(a.node, b.node), cover(a.span, b.span));
  if (a.kind == Kind::literal && b.kind == Kind::literal) {
    result.kind = Kind::literal;
  } else if (a.kind == Kind::literal && b.kind == Kind::known) {
    result.kind = Kind::known;
  } else if (a.kind == Kind::known) {
    auto const exponent = graph.constant_value(b.node);
    auto const rational = exponent ? to_rational(*exponent) : std::nullopt;
    if (a.unit.dimensionless()) {
      result.kind = Kind::known;
    } else if (rational) {
      result.kind = Kind::known;
      result.unit = *rational == Rational{1, 2} ? root(a.unit) : pure(sysid::power(a.unit, *rational));
      result.turns = a.turns * rational->numerator / rational->denominator;
    }
  }
  return unless_wrong(std::move(result), a, b);
}

Typed negate(Graph& graph, Typed const& a) {
  Typed result = a;
  result.node = graph.negate(a.node);
  return result;
}

Zeros compare_zeros(Graph const& graph, Typed const& a, Typed const& b, bool addends) {
  if (a.kind != Kind::known || b.kind != Kind::known || a.unit.dimension != b.unit.dimension || a.unit.offset == b.unit.offset)
    return Zeros::agree;
  bool const difference = zero_against_difference(a.unit, b.unit);
  if (addends) return difference ? Zeros::agree : Zeros::in_doubt;
  if (difference) return Zeros::of_difference;
  return graph.constant_value(a.node) || graph.constant_value(b.node) ? Zeros::agree : Zeros::apart;
}

Typed compare(Graph& graph, Operation operation, Typed a, Typed b) {
  Typed operands[] = {with_own_unit(std::move(a)), with_own_unit(std::move(b))};
  unify(graph, operands);
  return {graph.binary(operation, operands[0].node, operands[1].node), Kind::known, {}, cover_all(operands)};
}

Typed select(Graph& graph, Typed const& condition, Typed a, Typed b) {
  Typed operands[] = {with_own_unit(std::move(a)), with_own_unit(std::move(b))};
  auto const unit = unify(graph, operands);
  Typed result = shared(graph.select(condition.node, operands[0].node, operands[1].node), operands, unit);
  result.span = cover(condition.span, result.span);
  return result;
}

Typed call(Graph& graph, FunctionRow const& row, std::vector<Typed> arguments) {
  std::optional<Unit> unit;
  if (row.unit_rule == UnitRule::same || row.unit_rule == UnitRule::ratio) unit = unify(graph, arguments);
  if (row.unit_rule == UnitRule::branches) {
    std::vector<Typed> values;
    for (std::size_t i = 1; i < arguments.size(); i += 2) values.push_back(arguments[i]);
    values.push_back(arguments.back());
    unit = unify(graph, values);
    for (std::size_t i = 1; i < arguments.size(); i += 2) arguments[i].node = values[i / 2].node;
    arguments.back().node = values.back().node;
    std::vector<NodeId> nodes;
    for (Typed const& argument : arguments) nodes.push_back(argument.node);
    return shared(row.build(graph, nodes), values, unit);
  }
  std::vector<NodeId> nodes;
  for (Typed const& argument : arguments) nodes.push_back(argument.node);
  NodeId const node = row.build(graph, nodes);
  Typed result = shared(node, arguments, unit);
  switch (row.unit_rule) {
    case UnitRule::same:
    case UnitRule::branches:
      break;
    case UnitRule::root:
      if (arguments[0].kind == Kind::known) {
        result.kind = Kind::known;
        result.unit = root(arguments[0].unit);
        result.turns = arguments[0].turns / 2;
      }
      break;
    case UnitRule::dimensionless:
    case UnitRule::angle:
    case UnitRule::none:
    case UnitRule::ratio:
      if (result.kind != Kind::literal) {
        result.kind = Kind::known;
        result.unit = Unit{};
      }
      break;
  }
  return result;
}

}  // namespace sysid
