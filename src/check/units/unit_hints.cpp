// What is probably meant otherwise though the units agree: cycles and radians, conversions made twice, bare numbers in another unit
// than they look (E2210, E2213, E2214).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "check/units/product.hpp"
#include "check/units/unit_check.hpp"
#include "check/units/unit_errors.hpp"
#include "check/units/unit_words.hpp"
#include "check/units/units.hpp"
#include "core/text/number.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

/// A pure number to the SI that the unit tells from other pure numbers, as [deg] and [rev] do.
bool is_angle(Unit const& unit) { return unit.dimensionless() && (unit.radian.numerator != 0 || unit.hertz.numerator != 0); }
bool is_scaled(Unit const& unit) { return unit.offset == 0 && std::fabs(unit.scale - 1) > 0.01; }

/// A number as it is written, to which a unit can be added: `30`, `-30`.
bool is_bare(ast::Expression const& tree) {
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node))
    return (*unary)->symbol == "-" && is_bare(*(*unary)->operand);
  auto const* number = std::get_if<ast::Number>(&tree.node);
  return number != nullptr && !number->unit;
}

/// A bare number that is an angle in degrees if it is one at all: 45 alone, 90 as a phase.
ast::Number const* number_of_degrees(ast::Expression const& tree, bool alone) {
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return number_of_degrees(*(*unary)->operand, alone);
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node)) {
    if ((*binary)->symbol != "+" && (*binary)->symbol != "-") return nullptr;
    auto const* const left = number_of_degrees(*(*binary)->left, false);
    return left != nullptr ? left : number_of_degrees(*(*binary)->right, false);
  }
  auto const* number = std::get_if<ast::Number>(&tree.node);
  if (number == nullptr || number->unit) return nullptr;
  bool const degrees =
      alone ? number->value >= 10 && number->value <= 720 && std::fmod(number->value, 5) == 0 : is_usual_in_degrees(number->value);
  return degrees ? number : nullptr;
}

bool reads(ast::Expression const& tree, std::string const& name) {
  bool found = false;
  each_reference(tree, [&](ast::Reference const& reference) { found = found || reference.name.text == name; });
  return found;
}

}  // namespace

void UnitCheck::hint_cycles(std::span<UnitOperand const> operands) {
  auto const angular = [&](UnitOperand const& cycles, UnitOperand const& other) {
    return declared_.used_as_angular(cycles.tree, cycles.value.unit, other.tree, other.value.unit);
  };
  for (std::size_t i = 0; i < operands.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      Unit const &a = operands[j].value.unit, &b = operands[i].value.unit;
      if (!is_known(operands[i]) || !is_known(operands[j])) continue;
      if (cycles_against_radians(a, b)) {
        bool const shows_second = operands[i].tree != nullptr;  // the expression rather than a declaration
        UnitOperand const &shown = operands[shows_second ? i : j], &other = operands[shows_second ? j : i];
        bool const counts_cycles = shown.value.unit.hertz.numerator > other.value.unit.hertz.numerator;
        std::string const moved = shown.tree == nullptr ? std::string() : with_turns_moved(*shown.tree, counts_cycles);
        report(errors::cycles_meet_radians(unit_label(shown), unit_label(other), counts_cycles, moved));
        return;
      }
      bool const first = angular(operands[j], operands[i]);
      if (first || angular(operands[i], operands[j])) {
        UnitOperand const &shown = operands[first ? j : i], &other = operands[first ? i : j];
        report(errors::cycles_as_angular(unit_label(shown), unit_label(other), declared_.frequency_in(*shown.tree)));
        return;
      }
    }
}

bool UnitCheck::converted_angle(UnitOperand const& operand, bool in_function) {
  if (operand.tree == nullptr || !is_angle(operand.value.unit)) return false;
  auto taken = taken_from_product(*operand.tree, std::numbers::pi / 180);
  // Elsewhere the number of degrees may be wanted: a coefficient per degree, a table of degrees.
  if (!taken && in_function) taken = taken_from_product(*operand.tree, 180 / std::numbers::pi);
  if (taken) report(errors::angle_converted(operand.value.span, taken->factor, taken->sign + taken->rest));
  return taken.has_value();
}

// `1000*y` in [mm], `60*fn` in [rpm].
bool UnitCheck::hint_converted_twice(std::span<UnitOperand const> operands) {
  auto const declared =
      std::find_if(operands.begin(), operands.end(), [](UnitOperand const& each) { return each.tree == nullptr; });
  for (UnitOperand const& each : operands) {
    if (each.tree == nullptr || !is_known(each)) continue;
    if (declared != operands.end() && is_known(*declared) && is_scaled(declared->value.unit)) {
      Unit const& unit = declared->value.unit;
      bool const turns = unit.radian.numerator == 1 && each.value.unit.radian.numerator == 0;
      auto taken = taken_from_product(*each.tree, 1 / unit.scale);
      if (auto cycles = turns && !taken ? taken_from_product(*each.tree, 2 * std::numbers::pi / unit.scale) : std::nullopt) {
        cycles->rest = cycles->rest.starts_with("1/") ? "2*pi" + cycles->rest.substr(1) : "2*pi*" + cycles->rest;
        taken = cycles;
      }
      if (taken) {
        report(errors::converted_twice({each.value.span, ""}, unit_label(*declared), taken->factor, words(unit),
                                       taken->sign + taken->rest));
        return true;
      }
    }
    if (converted_angle(each, false) || (declared == operands.end() && converted_factor(each, operands))) return true;
  }
  return false;
}

// `1000*k*y` with k in [N/mm], among terms of an equation. Of a pure number the number itself may be wanted; a number times a name
// alone, or beside other terms with the name, is a coefficient: 0.001*x in a smoothing filter.
bool UnitCheck::converted_factor(UnitOperand const& operand, std::span<UnitOperand const> operands) {
  if (!calls_.empty()) return false;  // names are arguments there
  for (ProductFactor const& factor : product_factors(*operand.tree)) {
    auto const* name = std::get_if<ast::Reference>(&factor.tree->node);
    Unit const* const unit = name == nullptr ? nullptr : declared_.unit_of(name->name.text);
    if (unit == nullptr || !is_scaled(*unit) || unit->dimension == Dimension{} || name->name.text.find('[') != std::string::npos)
      continue;
    bool const elsewhere = std::ranges::any_of(operands, [&](UnitOperand const& each) {
      return each.tree != nullptr && each.tree != operand.tree && reads(*each.tree, name->name.text);
    });
    if (elsewhere || unit->dimension == operand.value.unit.dimension) continue;
    auto const taken = taken_from_product(*operand.tree, factor.divides ? 1 / unit->scale : unit->scale);
    if (!taken) continue;
    report(errors::factor_converted(operand.value.span, taken->factor, name->name.text, words(*unit), taken->sign + taken->rest));
    return true;
  }
  return false;
}

// Beside a pure number a bare number is one: 1 + a/L is not 1 mm/m more than a/L. Beside an angle in degrees few expect that.
void UnitCheck::hint_bare_numbers(std::span<UnitOperand const> operands) {
  auto const scaled = std::find_if(operands.begin(), operands.end(), [](UnitOperand const& each) {
    return each.tree != nullptr && is_known(each) && each.value.unit.dimensionless() && is_scaled(each.value.unit) &&
           !each.value.unit.text.empty();
  });
  if (scaled == operands.end()) return;
  bool const angle = is_angle(scaled->value.unit);
  for (UnitOperand const& each : operands) {
    if (each.tree == nullptr || each.value.kind != Typed::Kind::literal) continue;
    auto const value = graph_->constant_value(each.value.node);
    if (!value || *value == 0 || std::isinf(*value)) continue;
    // `abs(phi) + 1e-6` keeps a quotient finite.
    constexpr double regulariser = 1e-3;
    bool const clear =
        angle ? std::fabs(*value) < regulariser || to_rational(*value / std::numbers::pi).has_value() : std::fabs(*value) <= 1;
    if (clear) continue;
    bool const number = is_bare(*each.tree);
    auto const* name = std::get_if<ast::Reference>(&each.tree->node);
    report(errors::number_beside(each.value.span, unit_label(*scaled), angle, unparse(*each.tree), words(scaled->value.unit),
                                 number            ? ""
                                 : name == nullptr ? "1"
                                                   : name->name.text));
    return;
  }
}

// `let gap = 0.1` beside y in [mm]: written in place it would be 0.1 mm, by its name it is 0.1 m.
void UnitCheck::hint_constants(std::span<UnitOperand const> operands) {
  constexpr double regulariser = 1e-3;  // `abs(v) + eps` keeps a quotient finite
  if (!calls_.empty()) return;          // names are arguments there
  UnitOperand const* scaled = nullptr;
  for (UnitOperand const& each : operands) {
    if (each.tree == nullptr || !is_known(each) || each.value.unit.dimension == Dimension{}) continue;
    if (!is_scaled(each.value.unit)) return;
    if (!each.value.unit.text.empty()) scaled = &each;
  }
  if (scaled == nullptr) return;
  for (UnitOperand const& each : operands) {
    auto const* name = each.tree == nullptr ? nullptr : std::get_if<ast::Reference>(&each.tree->node);
    if (name == nullptr || each.value.kind != Typed::Kind::unknown || name->name.text.find_first_of(".[") != std::string::npos)
      continue;
    auto const value = graph_->constant_value(each.value.node);
    if (!value || std::fabs(*value) < regulariser || std::isinf(*value)) continue;
    Unit base = scaled->value.unit;
    base.scale = 1;
    base.text.clear();
    report(errors::constant_beside(each.value.span, unit_label(*scaled), name->name.text, words(scaled->value.unit), words(base)));
    return;
  }
}

void UnitCheck::hint_degrees(std::string const& function, UnitOperand const& argument) {
  ast::Number const* const number = argument.tree == nullptr ? nullptr : number_of_degrees(*argument.tree, true);
  if (number == nullptr) return;
  auto const& before = diagnostics_->all();
  bool const reported = std::ranges::any_of(before, [&](Diagnostic const& each) {
    return each.code == "E2213" && each.primary && each.primary->span.begin == number->span.begin;
  });
  if (!reported) report(errors::degrees_as_radians(number->span, function, shortest(number->value)));
}

void UnitCheck::hint_degrees_given(Occasion const& occasion, std::span<UnitOperand const> operands) {
  if (occasion.kind != Occasion::Kind::declared || operands.size() != 2) return;
  UnitOperand const &value = operands[0], &declared = operands[1];
  if (value.tree == nullptr || declared.tree != nullptr || !is_known(declared)) return;
  Unit const& unit = declared.value.unit;
  if (!unit.dimensionless() || unit.radian != Rational{1, 1} || unit.scale != 1) return;
  ast::Number const* const number = number_of_degrees(*value.tree, true);
  if (number == nullptr || !is_bare(*value.tree)) return;
  report(errors::degrees_given_to(value.value.span, unit_label(declared), occasion.what, unparse(*value.tree)));
}

}  // namespace sysid
