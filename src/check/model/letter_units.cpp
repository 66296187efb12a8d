// The model is checked again with the other unit in the place of the letter, and the messages are compared.
#include "check/model/letter_units.hpp"

#include <algorithm>
#include <iterator>
#include <optional>
#include <set>
#include <string>

#include "check/model/mistakes.hpp"
#include "check/model/model_checker.hpp"
#include "check/units/unit_errors.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

/// Puts [degC] where [C] stands alone, and [K] where it is a factor of a unit, as in [J/C]. Returns the place of the first.
std::optional<Span> replace_letter(ast::Model& model, errors::LetterUnit const& letter) {
  std::optional<Span> first;
  auto const replace = [&](ast::UnitExpression& unit) {
    bool const alone = unit.factors.size() == 1 && !unit.factors.front().exponent && !unit.factors.front().reciprocal;
    for (ast::UnitFactor& factor : unit.factors) {
      auto* name = std::get_if<ast::Name>(&factor.base);
      if (name == nullptr || name->text != letter.letter) continue;
      first = first.value_or(unit.span);
      name->text = alone ? letter.temperature : letter.difference;
    }
  };
  each_declared(model, [&](ast::Declared& each) {
    if (each.unit) replace(*each.unit);
  });
  for (ast::ModelStatement& statement : model.statements)
    each_top_expression(statement, [&](ast::Expression& top) {
      each_expression(top, [&](ast::Expression& part) {
        if (auto* number = std::get_if<ast::Number>(&part.node); number != nullptr && number->unit) replace(*number->unit);
      });
    });
  return first;
}

}  // namespace

void blame_letters(ast::Model const& model, std::vector<ast::FunctionDefinition const*> const& shared, std::size_t first,
                   Diagnostics& diagnostics) {
  std::set<Mistake> const before = mistakes_from(first, diagnostics);
  bool const conflict = std::any_of(diagnostics.all().begin() + static_cast<std::ptrdiff_t>(first), diagnostics.all().end(),
                                    [](Diagnostic const& each) { return errors::is_unit_conflict(each); });
  if (!conflict || model.statements.size() > most_statements) return;
  for (errors::LetterUnit const& letter : errors::letter_units) {
    ast::Model changed = model;
    auto const place = replace_letter(changed, letter);
    if (!place) continue;
    Diagnostics said;
    ModelChecker(changed, shared, said).run();
    std::set<Mistake> const after = mistakes_from(0, said);
    if (after.size() >= before.size() || !std::includes(before.begin(), before.end(), after.begin(), after.end())) continue;
    std::set<Mistake> resolved;
    std::set_difference(before.begin(), before.end(), after.begin(), after.end(), std::inserter(resolved, resolved.end()));
    replace_resolved(diagnostics, first, resolved, [&](Diagnostic earliest) {
      return errors::letter_taken_for_temperature(std::move(earliest), *place, letter);
    });
    return;
  }
}

}  // namespace sysid
