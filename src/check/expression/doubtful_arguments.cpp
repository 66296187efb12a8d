// By the size of numbers and by `pi` in the text.
#include "check/expression/doubtful_arguments.hpp"

#include <algorithm>

#include "check/message/errors.hpp"
#include "check/units/units.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

/// `2*pi`, `pi/4`: pi in a numerator, and no number with a unit.
bool looks_like_radians(ast::Expression const& tree) {
  bool has_pi = false, otherwise = false;
  each_expression(tree, [&](ast::Expression const& part) {
    if (auto const* name = std::get_if<ast::Reference>(&part.node)) (name->name.text == "pi" ? has_pi : otherwise) = true;
    if (auto const* number = std::get_if<ast::Number>(&part.node)) otherwise = otherwise || number->unit || number->value > 100;
    if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&part.node); binary != nullptr && (*binary)->symbol == "/")
      otherwise = otherwise || !std::holds_alternative<ast::Number>((*binary)->right->node);
  });
  return has_pi && !otherwise;
}

bool looks_like_degrees(ast::Expression const& tree) {
  if (auto const* minus = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return looks_like_degrees(*(*minus)->operand);
  auto const* number = std::get_if<ast::Number>(&tree.node);
  return number != nullptr && !number->unit && is_usual_in_degrees(number->value);
}

}  // namespace

bool is_of_logarithm(DistributionRow const& row) {
  return std::ranges::any_of(row.arguments.front().spellings, &Spelling::logarithm);
}

std::optional<Diagnostic> doubtful_width_of_logarithm(WrittenArgument const& given, std::optional<double> width,
                                                      std::string const& distribution) {
  constexpr double absurd = 10;
  if (!width || !(*width > absurd)) return std::nullopt;
  return errors::wide_logarithm(given.span, distribution, std::string(given.spelling.name), unparse(given.tree));
}

std::optional<Diagnostic> doubtful_angle(WrittenArgument const& given, Quantity const& variate) {
  std::optional<Unit> const& unit = variate.unit;
  if (!unit || !unit->dimensionless() || unit->radian.numerator != 1 || given.spelling.unit_power != 1) return std::nullopt;
  bool const radians = unit->scale == 1;
  if (!radians && unit->text_or_dimension() != "deg") return std::nullopt;
  if (radians ? !looks_like_degrees(given.tree) : !looks_like_radians(given.tree)) return std::nullopt;
  return errors::angle_in_other_unit(given.span, unparse(given.tree), variate.name.substr(0, variate.name.find('[')),
                                     unit->text_or_dimension(), radians ? "deg" : "rad");
}

}  // namespace sysid
