// Canonical text of expressions and of what stands in all statements alike; those of unparse.hpp beside.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "syntax/ast.hpp"
#include "syntax/unparse.hpp"

namespace sysid {

template <class Items, class Print>
std::string joined(Items const& items, std::string_view separator, Print print) {
  std::string out;
  for (auto const& item : items) {
    if (&item != &items.front()) out += separator;
    out += print(item);
  }
  return out;
}

/// The shortest digits that read back as the same number; 1e-4 rather than 1e-04.
std::string number_text(double value);
/// In quotes, escapes written.
std::string string_literal(std::string_view text);
/// " [m]"; nothing for none.
std::string bracketed(std::optional<ast::UnitExpression> const& unit);

/// An expression with which a statement begins: in parentheses where it would begin with a sign.
std::string leading_text(ast::Expression const& expression);
std::string text_of(ast::Name const& name);
std::string text_of(ast::Reference const& reference);
std::string text_of(ast::Declared const& declared);
std::string text_of(ast::Argument const& argument);
std::string text_of(ast::Call const& call);

}  // namespace sysid
