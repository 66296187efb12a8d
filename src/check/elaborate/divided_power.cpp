// In the tree as it was parsed: arguments of models may put a 1 into a power later.
#include "check/elaborate/divided_power.hpp"

#include <cmath>

#include "check/message/errors.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

std::optional<double> bare_whole(ast::Expression const& tree) {
  auto const* number = std::get_if<ast::Number>(&tree.node);
  if (number == nullptr || number->unit || number->value != std::floor(number->value)) return std::nullopt;
  return number->value;
}

/// The power that is divided: the dividend, or the last factor of it.
ast::Binary const* power_above(ast::Binary const& quotient) {
  auto const* above = std::get_if<ast::Box<ast::Binary>>(&quotient.left->node);
  if (above != nullptr && ((*above)->symbol == "*" || (*above)->symbol == "/"))
    above = std::get_if<ast::Box<ast::Binary>>(&(*above)->right->node);
  return above != nullptr && (*above)->symbol == "^" ? &**above : nullptr;
}

void look_at(ast::Expression const& tree, Diagnostics& diagnostics) {
  each_expression(tree, [&](ast::Expression const& each) {
    auto const* quotient = std::get_if<ast::Box<ast::Binary>>(&each.node);
    if (quotient == nullptr || (*quotient)->symbol != "/") return;
    ast::Binary const* const power = power_above(**quotient);
    auto const divisor = bare_whole(*(*quotient)->right);
    if (power != nullptr && divisor && *divisor > 1 && bare_whole(*power->right) == 1)
      diagnostics.add(errors::divided_power(*power, *(*quotient)->right));
  });
}

}  // namespace

void refuse_divided_powers(ast::File const& file, Diagnostics& diagnostics) {
  auto const look = [&](ast::Expression const& tree) { look_at(tree, diagnostics); };
  for (ast::Item const& item : file.items) {
    if (auto const* model = std::get_if<ast::Model>(&item))
      for (ast::ModelStatement const& statement : model->statements) each_top_expression(statement, look);
    if (auto const* function = std::get_if<ast::FunctionDefinition>(&item)) look(function->value);
    if (auto const* dictionary = std::get_if<ast::Dictionary>(&item))
      for (ast::DictionaryStatement const& statement : dictionary->statements) {
        if (auto const* list = std::get_if<ast::DictionaryList>(&statement))
          for (ast::Expression const& each : list->items) look(each);
        if (auto const* definition = std::get_if<ast::Definition>(&statement)) look(definition->value);
        if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) look(function->value);
      }
  }
}

}  // namespace sysid
