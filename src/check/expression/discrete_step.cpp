// A number of seconds, or of a unit that is converted to them.
#include "check/expression/discrete_step.hpp"

#include <fmt/format.h>

#include "check/message/errors.hpp"
#include "check/units/units.hpp"
#include "core/text/number.hpp"

namespace sysid {

std::optional<double> declared_step(ast::DiscreteTimeDeclaration const& discrete, Scope& scope) {
  if (!discrete.step) return std::nullopt;
  Unit const second = unit_atom("s").value();
  auto const value = scope.expression(*discrete.step);
  if (!value) return std::nullopt;
  if (value->kind == Typed::Kind::known && value->unit.dimension != second.dimension) {
    Diagnostic refused = errors::number_of_other_kind(discrete.step->span, {"the time between samples"}, value->unit, second);
    Unit const hertz = unit_atom("Hz").value();
    auto const rate = value->unit.dimension == hertz.dimension && !cycles_against_radians(value->unit, hertz)
                          ? scope.graph().constant_value(adapt(scope.graph(), *value, hertz))
                          : std::nullopt;
    if (rate && *rate > 0)
      refused.help = fmt::format("this is a number of samples per time: write `time discrete {} [s]`", shortest(1 / *rate));
    scope.diagnostics().add(std::move(refused));
    return std::nullopt;
  }
  auto const step = scope.graph().constant_value(adapt(scope.graph(), *value, second));
  if (step && *step > 0) return step;
  scope.diagnostics().add(errors::rate_not_positive(discrete.step->span));
  return std::nullopt;
}

}  // namespace sysid
