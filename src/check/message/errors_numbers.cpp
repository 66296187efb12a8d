// The wording of errors_numbers.hpp.
#include "check/message/errors_numbers.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/message/error_words.hpp"
#include "check/message/errors_reuse.hpp"
#include "core/numeric/unit.hpp"
#include "syntax/unparse.hpp"

namespace sysid::errors {
namespace {

/// Whether an expression is made of units, as `N/m` is.
bool of_units(ast::Expression const& expression) {
  if (auto const* reference = std::get_if<ast::Reference>(&expression.node)) return unit_atom(reference->name.text).has_value();
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&expression.node)) {
    if ((*binary)->symbol == "^") return of_units(*(*binary)->left);
    return ((*binary)->symbol == "*" || (*binary)->symbol == "/") && of_units(*(*binary)->left) && of_units(*(*binary)->right);
  }
  return false;
}

/// Empty where it is unknown.
std::string instead_of_size(ast::Declared const& declared) {
  ast::Expression const& size = declared.sizes.front();
  std::string const& name = declared.name.text;
  std::string const written = unparse(size);
  if (written == "t" || written == "time")
    return fmt::format("write `{}` without `({})`: a quantity is written without its time", name, written);
  std::string const number = fmt::format("a size is a number or an argument of the model: `{}(3)`", name);
  if (of_units(size)) return fmt::format("a unit is written in brackets: `{} [{}]`; {}", name, written, number);
  if (std::holds_alternative<ast::Reference>(size.node))
    return fmt::format("{}; a function is written `function {}({}) = ...`", number, name, written);
  return {};
}

}  // namespace

Diagnostic argument_not_finite(Span span, std::string const& spelling, std::string const& distribution) {
  std::string_view const help =
      spelling == "upper"
          ? "write the largest value that is possible; `half_normal(sd = 1)` and `log_normal(1, sd = 1)` have no upper limit"
      : spelling == "lower" ? "write the smallest value that is possible; `normal(0, sd = 1)` has no lower limit"
                            : "write a number";
  return about({distribution, spelling},
               error("E2112", span, fmt::format("the arguments of `{}` are invalid: `{}` must be finite", distribution, spelling),
                     std::string(help)));
}

Diagnostic value_not_finite(Span span, Subject const& what) {
  return about(what.names, error("E2015", span, fmt::format("{} must be a finite number", what.words),
                                 "write a number; an unknown parameter has a prior in place of a value: `~ log_uniform(0.1, 10)`"));
}

Diagnostic parts_overlap(NamedRows const& later, NamedRows const& earlier) {
  int const from = std::max(later.first, earlier.first), to = std::min(later.last, earlier.last);
  std::string const rows = from == to ? fmt::format("row {}", from) : fmt::format("rows {} to {}", from, to);
  std::string const crossing = later.first > earlier.first ? fmt::format("begin `{}` at row {}", later.name, to + 1)
                                                           : fmt::format("end `{}` at row {}", later.name, from - 1);
  bool const same = later.first == earlier.first && later.last == earlier.last;
  return about({later.name, earlier.name}, conflict("E4116", later.span, "again here", earlier.span, "first here",
                                                    fmt::format("{} {} in both ranges `{}` and `{}`", rows,
                                                                from == to ? "is" : "are", earlier.name, later.name),
                                                    same ? fmt::format("remove `{}`, or give it other rows", later.name)
                                                         : "both ends of a range belong to it: " + crossing));
}

Diagnostic size_needed(ast::Declared const& declared, std::size_t which) {
  Diagnostic needed = whole_number_needed(declared.sizes[which].span, named("a size of", declared.name.text));
  if (std::string meant = instead_of_size(declared); which == 0 && !meant.empty()) needed.help = std::move(meant);
  return needed;
}

}  // namespace sysid::errors
