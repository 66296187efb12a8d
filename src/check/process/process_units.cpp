// Solves for the units that hyper-parameters and uses of the process leave open.
#include "check/process/process_units.hpp"

#include <algorithm>

#include "check/expression/scope.hpp"
#include "check/message/errors.hpp"

namespace sysid {
namespace {

/// What is known of the units of a process, as more of its hyper-parameters are looked at.
struct KnownUnits {
  std::vector<std::optional<Unit>> columns;
  std::optional<Unit> output, own;
};

/// output^a * input^b * own^c, where all that take part are known.
std::optional<Unit> product(KnownUnits const& known, HyperParameterGiven const& given) {
  Unit result;
  auto const take = [&](std::optional<Unit> const& unit, int exponent) {
    if (exponent == 0) return true;
    if (!unit) return false;
    result = multiply(result, power(*unit, {exponent, 1}));
    return true;
  };
  auto const& input = given.column < 0 ? std::nullopt : known.columns[static_cast<std::size_t>(given.column)];
  if (!take(known.output, given.row->unit.output) || !take(input, given.row->unit.input) || !take(known.own, given.row->unit.own))
    return std::nullopt;
  return result;
}

/// Finds the one unit that a hyper-parameter of known unit still leaves open; false where it finds none.
bool learn(KnownUnits& known, HyperParameterGiven const& given) {
  auto const unit = known_unit(given.value);
  if (!unit) return false;
  struct Part {
    std::optional<Unit>* unit;
    int exponent;
  };
  std::optional<Unit> none;
  std::optional<Unit>* const input = given.column < 0 ? &none : &known.columns[static_cast<std::size_t>(given.column)];
  std::vector<Part> open;
  Unit rest = *unit;
  for (Part const part :
       {Part{&known.output, given.row->unit.output}, Part{input, given.row->unit.input}, Part{&known.own, given.row->unit.own}}) {
    if (part.exponent == 0) continue;
    if (*part.unit)
      rest = divide(rest, power(**part.unit, {part.exponent, 1}));
    else
      open.push_back(part);
  }
  if (open.size() != 1) return false;
  *open.front().unit = open.front().exponent == 1 ? rest : power(rest, {1, open.front().exponent});
  return true;
}

}  // namespace

std::optional<Unit> known_unit(Typed const& value) {
  return value.kind == Typed::Kind::known ? std::optional(value.unit) : std::nullopt;
}

bool resolve_units(Scope& scope, ast::ProcessDefinition const& definition, HyperParametersGiven const& given,
                   std::vector<std::optional<Unit>> const& columns, Process& process) {
  std::vector<std::optional<Unit>> outputs;
  for (std::size_t k = 0; k < given.size(); ++k) {
    KnownUnits known{columns, {}, {}};
    // What has no unit of its own takes the one that the hyper-parameters leave it.
    for (std::size_t round = 0; round <= given[k].size(); ++round)
      if (std::none_of(given[k].begin(), given[k].end(), [&](HyperParameterGiven const& each) { return learn(known, each); }))
        break;
    for (HyperParameterGiven const& each : given[k]) {
      auto const wanted = product(known, each);
      auto const unit = known_unit(each.value);
      if (wanted && unit && wanted->dimension != unit->dimension) {
        Quantity const none, &input = each.column < 0 ? none : process.inputs[static_cast<std::size_t>(each.column)];
        auto const of_input = each.column < 0 ? std::nullopt : columns[static_cast<std::size_t>(each.column)];
        scope.diagnostics().add(errors::hyper_parameter_unit(each.value.span, std::string(each.row->name), input.name, *unit,
                                                             *wanted, input.span, of_input));
        return false;
      }
      process.kernels[k].hyper_parameters.push_back(adapt(scope.graph(), each.value, wanted));
    }
    outputs.push_back(known.output);
  }
  // Kernels that are added share the unit of their values; of those multiplied the units are multiplied.
  std::vector<std::optional<Unit>> units;
  for (Process::Covariance const& each : process.covariance) {
    auto const left = static_cast<std::size_t>(each.left), right = static_cast<std::size_t>(each.right);
    if (each.kind == Process::Covariance::Kind::kernel) {
      units.push_back(outputs[left]);
    } else if (each.kind == Process::Covariance::Kind::product) {
      units.push_back(units[left] && units[right] ? std::optional(multiply(*units[left], *units[right])) : std::nullopt);
    } else {
      if (units[left] && units[right] && units[left]->dimension != units[right]->dimension) {
        scope.diagnostics().add(errors::kernels_of_other_units(definition.process.span, *units[left], *units[right]));
        return false;
      }
      units.push_back(units[left] ? units[left] : units[right]);
    }
  }
  process.unit = units.back();
  return true;
}

}  // namespace sysid
