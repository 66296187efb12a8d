// A checked expression: a node of the model's graph in coherent SI, and what is known of its unit. Literals stay adaptable until
// they meet something with a unit.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "core/numeric/unit.hpp"
#include "expression/function.hpp"
#include "expression/graph.hpp"

namespace sysid {

struct Typed {
  enum class Kind {
    literal,  // made of untagged numbers only: takes the unit of what it is added to, compared with or assigned to
    known,    // a unit is known
    unknown,  // something undeclared takes part: unchecked
    wrong,    // a mistake in it has been reported: nothing that follows from it is one
  };
  NodeId node = 0;
  Kind kind = Kind::unknown;
  Unit unit{};  // when known
  Span span;
  int turns =
      0;  // powers of pi among the bare factors of a product, for what its unit counts (cycles or radians): see `with_own_unit`
};

/// The same where its product ends: 2*pi has made radians of cycles, 1/(2*pi) cycles of radians.
Typed with_own_unit(Typed typed);

Typed literal(Graph& graph, double value, Span span);
/// A number tagged with a unit: SI inside, but a temperature stays in degrees above the zero of its unit.
Typed tagged(Graph& graph, double value, Unit const& unit, Span span);
Typed with_unit(NodeId node, std::optional<Unit> const& unit, Span span);

/// What becomes of two temperatures, or a temperature and a difference of two, where they meet. Zero points of numbers are
/// converted, those of expressions are not: a quantity in [K] may be a temperature or a difference, and only its user knows.
enum class Zeros {
  agree,          // one zero point, or a number that is converted to it; in a sum, a temperature and a difference
  in_doubt,       // addends with zero points of their own, or with one in [K]
  of_difference,  // a difference where a temperature is wanted, or the other way round
  apart,          // temperatures in units with different zero points
};
/// addends: they are added or subtracted; otherwise one stands for the other (sides, branches, a declaration and its value).
Zeros compare_zeros(Graph const& graph, Typed const& a, Typed const& b, bool addends);

/// `typed` where a quantity of `unit` is expected: a literal is scaled; degrees are shifted between temperature units; else
/// unchanged.
NodeId adapt(Graph& graph, Typed const& typed, std::optional<Unit> const& unit);
/// Brings operands that must share a unit (addends, sides, branches) to it: literals adapt to the first known unit.
std::optional<Unit> unify(Graph& graph, std::span<Typed> operands);

Typed add(Graph& graph, Typed a, Typed b, bool subtract);
Typed multiply(Graph& graph, Typed const& a, Typed const& b);
Typed divide(Graph& graph, Typed const& a, Typed const& b);
Typed power(Graph& graph, Typed const& a, Typed const& b);
Typed negate(Graph& graph, Typed const& a);
Typed compare(Graph& graph, Operation operation, Typed a, Typed b);
Typed select(Graph& graph, Typed const& condition, Typed a, Typed b);
Typed call(Graph& graph, FunctionRow const& row, std::vector<Typed> arguments);

}  // namespace sysid
