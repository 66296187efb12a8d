// By the tree alone: what units its names have is known elsewhere.
#include "check/units/term_shape.hpp"

#include <algorithm>

#include "core/numeric/unit.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {

ast::Expression const* bare_factor(ast::Expression const& tree) {
  if (auto const* number = std::get_if<ast::Number>(&tree.node)) return number->unit ? nullptr : &tree;
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return bare_factor(*(*unary)->operand);
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/")) return nullptr;
  ast::Expression const* left = bare_factor(*(*binary)->left);
  return left != nullptr || (*binary)->symbol == "/" ? left : bare_factor(*(*binary)->right);
}

std::vector<std::string> names_in(ast::Expression const& tree) {
  std::vector<std::string> names;
  each_reference(tree, [&](ast::Reference const& reference) { names.push_back(reference.name.text); });
  return names;
}

bool is_measured_number(ast::Expression const& tree) {
  auto const* number = std::get_if<ast::Number>(&tree.node);
  auto const fraction = number == nullptr ? std::nullopt : to_rational(number->value);
  constexpr int of_formulas = 4;
  return number != nullptr && (!fraction || fraction->denominator > of_formulas);
}

std::optional<std::pair<std::string, std::string>> turned_over(ast::Expression const& tree) {
  ast::Binary const* only = nullptr;
  int quotients = 0;
  each_expression(tree, [&](ast::Expression const& part) {
    auto const* binary = std::get_if<ast::Box<ast::Binary>>(&part.node);
    if (binary == nullptr || (*binary)->symbol != "/") return;
    ++quotients;
    only = &**binary;
  });
  auto const simple = [](ast::Expression const& side) { return std::holds_alternative<ast::Reference>(side.node); };
  if (quotients != 1 || !simple(*only->left) || !simple(*only->right)) return std::nullopt;
  std::vector<std::string> names = names_in(tree);
  std::erase(names, "pi");
  if (names.size() != 2) return std::nullopt;  // one of them stands elsewhere, too
  std::string const above = unparse(*only->left), below = unparse(*only->right);
  return std::pair(above + "/" + below, below + "/" + above);
}

std::optional<int> factor_power(ast::Expression const& tree, std::string const& name) {
  std::vector<std::string> const used = names_in(tree);
  if (std::find(used.begin(), used.end(), name) == used.end()) return 0;
  if (std::holds_alternative<ast::Reference>(tree.node)) return 1;
  if (auto const* unary = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return factor_power(*(*unary)->operand, name);
  auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node);
  if (binary == nullptr || ((*binary)->symbol != "*" && (*binary)->symbol != "/")) return std::nullopt;
  auto const left = factor_power(*(*binary)->left, name), right = factor_power(*(*binary)->right, name);
  if (!left || !right) return std::nullopt;
  return (*binary)->symbol == "*" ? *left + *right : *left - *right;
}

}  // namespace sysid
