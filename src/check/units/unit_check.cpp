// Operands are grouped by dimension; the largest group is taken to be right, and the others are shown against it.
#include "check/units/unit_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "check/units/unit_errors.hpp"
#include "check/units/unit_words.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

Dimension const& dimension_of(UnitOperand const& operand) { return operand.value.unit.dimension; }

std::size_t size_of(UnitOperand const& operand) {
  std::size_t size = 0;  // a declaration: what the user says plainly
  if (operand.tree != nullptr) each_expression(*operand.tree, [&](ast::Expression const&) { ++size; });
  return size;
}

// The indices of known operands, those of one dimension together.
using Groups = std::vector<std::vector<std::size_t>>;

Groups group(std::span<UnitOperand const> operands) {
  Groups groups;
  for (std::size_t i = 0; i < operands.size(); ++i) {
    if (!is_known(operands[i])) continue;
    auto const place = std::find_if(groups.begin(), groups.end(), [&](std::vector<std::size_t> const& each) {
      return dimension_of(operands[each.front()]) == dimension_of(operands[i]);
    });
    if (place == groups.end())
      groups.push_back({i});
    else
      place->push_back(i);
  }
  return groups;
}

// The most numerous; of equals the one with the plainest member: `x` is more surely what it should be than `k*y^2`.
std::vector<std::size_t> majority(Groups const& groups, std::span<UnitOperand const> operands) {
  auto const rank = [&](std::vector<std::size_t> const& members) {
    std::size_t plainest = SIZE_MAX;
    for (std::size_t const i : members) plainest = std::min(plainest, size_of(operands[i]));
    return std::pair(members.size(), SIZE_MAX - plainest);
  };
  return *std::max_element(groups.begin(), groups.end(), [&](auto const& a, auto const& b) { return rank(a) < rank(b); });
}

// Where the operands of a row agree: those next to `odd`, before it if there are any, as one stretch of text.
struct Stretch {
  Span span;
  bool before = false;
  bool several = false;
};
Stretch agreeing(std::span<UnitOperand const> operands, std::vector<std::size_t> const& right, std::size_t odd, bool addends) {
  auto const agrees = [&](std::size_t i) { return std::find(right.begin(), right.end(), i) != right.end(); };
  auto const joins = [&](std::size_t i, std::size_t j) {
    return addends && operands[i].side == operands[j].side && operands[i].tree != nullptr && operands[j].tree != nullptr;
  };
  std::optional<std::size_t> nearest;
  for (std::size_t const i : right) {
    bool const same_side = joins(i, odd);
    if (!nearest || (same_side && (i < odd || !joins(*nearest, odd)))) nearest = i;
  }
  std::size_t first = *nearest, last = *nearest;
  while (first > 0 && agrees(first - 1) && joins(first - 1, first)) --first;
  while (last + 1 < operands.size() && agrees(last + 1) && joins(last + 1, last)) ++last;
  return {cover(operands[first].value.span, operands[last].value.span), last<odd, last> first};
}

/// All terms of a value have one dimension, so that it is the value that is meant otherwise, and not one of its terms.
bool terms_alike(Groups const& groups, std::span<UnitOperand const> operands) {
  return groups.size() == 2 && std::any_of(groups.begin(), groups.end(), [&](std::vector<std::size_t> const& members) {
           return members.size() == 1 && operands[members.front()].tree == nullptr;
         });
}

}  // namespace

Label UnitCheck::unit_label(UnitOperand const& operand) const {
  return {operand.value.span, "[" + words(operand.value.unit) + "]"};
}

void UnitCheck::remember(UnitOperand const& operand, std::string why) {
  if (operand.tree != nullptr && calls_.empty()) not_compared_.push_back({operand.tree, std::move(why)});
}

void UnitCheck::report(Diagnostic diagnostic) {
  if (!calls_.empty()) {
    // A mistake that does not depend on the arguments would be found again at each call.
    std::pair const place(diagnostic.primary->span, diagnostic.message + diagnostic.primary->text);
    auto const same = [&](auto const& each) { return each.first == place.first && each.second == place.second; };
    if (std::any_of(said_in_functions_.begin(), said_in_functions_.end(), same)) return;
    said_in_functions_.push_back(place);
    errors::move_to_call(diagnostic, calls_.front().span, calls_.back().function);
  }
  diagnostics_->add(std::move(diagnostic));
}

bool UnitCheck::agree(Occasion const& occasion, std::span<UnitOperand const> operands) {
  Groups const groups = group(operands);
  for (UnitOperand const& each : operands)
    if (each.value.kind == Typed::Kind::unknown) remember(each);
  if (groups.size() < 2) {
    hint_bare_numbers(operands);
    hint_constants(operands);
    hint_degrees_given(occasion, operands);
    if (!hint_converted_twice(operands)) hint_cycles(operands);
    return true;
  }
  std::vector<std::size_t> const right = majority(groups, operands);
  std::vector<std::size_t> odd;
  for (std::size_t i = 0; i < operands.size(); ++i)
    if (is_known(operands[i]) && std::find(right.begin(), right.end(), i) == right.end()) odd.push_back(i);
  auto const label = [&](Span span, std::size_t i) {
    bool const noted = operands[i].tree == nullptr && !occasion.note.empty();
    return Label{span, noted ? occasion.note : "[" + words(operands[i].value.unit) + "]"};
  };

  // A declaration that its whole value contradicts, or one side of an equation the other: shown as wholes.
  bool const declaration_alone = odd.size() == 1 && operands[odd.front()].tree == nullptr;
  bool whole_side = occasion.kind == Occasion::Kind::terms && groups.size() == 2;
  for (std::size_t i = 0; i < operands.size(); ++i)
    for (std::size_t const j : odd)
      if (is_known(operands[i]) && (operands[i].side == operands[j].side) != (std::find(odd.begin(), odd.end(), i) != odd.end()))
        whole_side = false;
  bool const has_declaration =
      std::any_of(operands.begin(), operands.end(), [](UnitOperand const& each) { return each.tree == nullptr; });
  bool const sum = has_declaration || occasion.kind == Occasion::Kind::terms;
  UnitConflict conflict;
  std::size_t const shown = declaration_alone ? right.front() : odd.front();
  Unit const& wanted = operands[declaration_alone ? odd.front() : right.front()].value.unit;
  conflict.primary = label(operands[shown].value.span, shown);
  if (declaration_alone) {
    conflict.primary.span = cover(operands[right.front()].value.span, operands[right.back()].value.span);
    conflict.secondary.push_back(label(operands[odd.front()].value.span, odd.front()));
  } else {
    Stretch const stretch = agreeing(operands, right, shown, sum);
    conflict.position = stretch.before ? UnitConflict::Position::after : UnitConflict::Position::before;
    conflict.several = stretch.several;
    if (whole_side) {
      conflict.position = UnitConflict::Position::other_side;
      conflict.primary.span = cover(operands[odd.front()].value.span, operands[odd.back()].value.span);
    }
    conflict.secondary.push_back(label(stretch.span, right.front()));
    for (std::size_t const i : odd)
      if (i != shown && !whole_side) conflict.secondary.push_back(label(operands[i].value.span, i));
  }
  conflict.wanted = words(wanted);
  conflict.found = words(operands[shown].value.unit);
  missing_.push_back(quotient(wanted.dimension, dimension_of(operands[shown])));
  auto const cure = std::find_if(occasion.cures.begin(), occasion.cures.end(), [&](auto const& each) {
    return terms_alike(groups, operands) && each.first == dimension_of(operands[shown]);
  });
  std::vector<ast::Expression const*> agreeing_trees;
  for (std::size_t const i : right)
    if (operands[i].tree != nullptr && i != shown) agreeing_trees.push_back(operands[i].tree);
  bool const of_a_number = dimension_of(operands[shown]) == Dimension{} && wanted.offset == 0;
  bool const is_term = occasion.kind == Occasion::Kind::terms;
  bool const whole = operands.size() == 2 && operands[shown].tree != nullptr && operands[1 - shown].tree == nullptr;
  bool const is_reciprocal =
      occasion.kind == Occasion::Kind::declared && whole && dimension_of(operands[shown]) == inverse(wanted.dimension);
  bool const is_width = occasion.kind == Occasion::Kind::distribution && occasion.is_width && whole;
  double const scale = !calls_.empty() ? 0 : wanted.text.empty() ? 1 : wanted.scale;
  conflict.help = cure != occasion.cures.end()
                      ? cure->second
                      : declared_.cure(operands[shown].tree,
                                       {conflict.wanted, missing_.back(), false, of_a_number, is_term, std::move(agreeing_trees),
                                        scale, is_reciprocal, is_width, occasion.of, occasion.location});
  // [g] is the gram.
  static Dimension const acceleration = unit_atom("g_n").value().dimension;
  bool const gram = conflict.wanted == "g" && dimension_of(operands[shown]) == acceleration;
  if (gram || (conflict.wanted == "mg" && dimension_of(operands[shown]) == acceleration))
    conflict.help = errors::gram_for_gravity(conflict.wanted);
  // Against other terms of its own sum a term is shown as such, whatever the sum is for.
  bool const among_terms = has_declaration && !declaration_alone && operands[right.front()].tree != nullptr;
  report(errors::units_differ(among_terms ? Occasion{} : occasion, std::move(conflict)));
  return false;
}

bool UnitCheck::pure(std::string const& function, UnitOperand const& argument, bool angle) {
  if (angle) hint_degrees(function, argument);
  if (argument.value.kind == Typed::Kind::unknown) remember(argument);
  if (!is_known(argument)) return true;
  Unit const& unit = argument.value.unit;
  if (unit.dimensionless()) {
    if (angle && converted_angle(argument, true)) return true;
    if (angle && unit.hertz.numerator != 0 && unit.radian.numerator == 0)
      report(errors::cycles_in_angle(argument.value.span, function));
    return true;
  }
  missing_.push_back(inverse(unit.dimension));
  report(errors::pure_argument({argument.value.span, "[" + words(unit) + "]"}, function,
                               declared_.cure(argument.tree, {"-", inverse(unit.dimension), true})));
  return false;
}

bool UnitCheck::power(UnitOperand const& base, UnitOperand const& exponent, std::optional<double> constant) {
  if (is_known(exponent) && !exponent.value.unit.dimensionless()) {
    missing_.push_back(inverse(exponent.value.unit.dimension));
    report(errors::exponent_with_unit({exponent.value.span, "[" + words(exponent.value.unit) + "]"},
                                      declared_.cure(exponent.tree, {"-", inverse(exponent.value.unit.dimension), true})));
    return false;
  }
  if (!is_known(base) || base.value.unit.dimensionless()) return true;
  if (constant) {
    if (!to_rational(*constant)) remember(base, "its exponent is neither a whole number nor a fraction of small whole numbers");
    return true;
  }
  std::string const unit = words(base.value.unit);
  report(errors::base_with_unit({base.value.span, "[" + unit + "]"}, exponent.value.span, unparse(*base.tree), unit));
  return false;
}

bool UnitCheck::one_zero(Graph const& graph, UnitOperand const& a, UnitOperand const& b, bool addends) {
  // A declaration has no node: what stands in its place is no number.
  Typed const& first = a.tree == nullptr ? b.value : a.value;
  Typed second = a.tree == nullptr ? a.value : b.value;
  if (a.tree == nullptr || b.tree == nullptr) second.node = first.node;
  Zeros const zeros = compare_zeros(graph, first, second, addends);
  if (zeros == Zeros::agree) return true;
  bool const shows_first = a.tree == nullptr || b.tree == nullptr || first.unit.offset == 0;
  auto const words_of = [&](Typed const& value, ast::Expression const* tree) {
    bool const is_name = tree != nullptr && std::holds_alternative<ast::Reference>(tree->node);
    bool const is_number = tree != nullptr && std::holds_alternative<ast::Number>(tree->node);
    return errors::Temperature{unit_label({value}), tree == nullptr ? "" : unparse(*tree), is_name, is_number, value.unit};
  };
  errors::Temperature const one = words_of(first, a.tree == nullptr ? b.tree : a.tree);
  errors::Temperature const two = words_of(second, a.tree == nullptr ? nullptr : b.tree);
  report(errors::zeros_differ(zeros, shows_first ? one : two, shows_first ? two : one));
  return false;
}

bool UnitCheck::one_zero(Graph const& graph, std::span<UnitOperand const> operands) {
  for (std::size_t i = 1; i < operands.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (!one_zero(graph, operands[j], operands[i], false)) return false;
  return true;
}

bool UnitCheck::condition(UnitOperand const& operand, bool before_value) {
  if (!is_known(operand) || operand.value.unit.dimensionless()) return true;
  report(errors::condition_with_unit({operand.value.span, "[" + words(operand.value.unit) + "]"}, unparse(*operand.tree),
                                     before_value));
  return false;
}

}  // namespace sysid
