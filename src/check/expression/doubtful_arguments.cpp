// By the size of numbers and by `pi` in the text.
#include "check/expression/doubtful_arguments.hpp"

#include <algorithm>
#include <cmath>

#include "check/message/errors.hpp"
#include "syntax/unparse.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

bool reads_pi(ast::Expression const& tree) {
  bool found = false;
  each_expression(tree, [&](ast::Expression const& part) {
    auto const* name = std::get_if<ast::Reference>(&part.node);
    found = found || (name != nullptr && name->name.text == "pi");
  });
  return found;
}

bool looks_like_degrees(ast::Expression const& tree) {
  constexpr double fewest = 30, step = 5;
  if (auto const* minus = std::get_if<ast::Box<ast::Unary>>(&tree.node)) return looks_like_degrees(*(*minus)->operand);
  auto const* number = std::get_if<ast::Number>(&tree.node);
  return number != nullptr && !number->unit && number->value >= fewest && std::fmod(number->value, step) == 0;
}

}  // namespace

bool is_of_logarithm(DistributionRow const& row) { return std::ranges::any_of(row.arguments.front().spellings, &Spelling::logarithm); }

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
  if (radians ? !looks_like_degrees(given.tree) : !reads_pi(given.tree)) return std::nullopt;
  return errors::angle_in_other_unit(given.span, unparse(given.tree), variate.name, unit->text_or_dimension(),
                                     radians ? "deg" : "rad");
}

}  // namespace sysid
