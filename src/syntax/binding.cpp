// The table, and one line for each kind of node.
#include "syntax/binding.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/text/diagnostic.hpp"

namespace sysid {

namespace {

/// sysid.ebnf's levels. The right operand of `^` may carry a sign; comparisons do not associate.
constexpr std::array<OperatorRow, 14> operators{{
    {"..", Binding::conditional, Binding::conditional, Binding::conditional},  // of arguments alone
    {"or", Binding::disjunction, Binding::disjunction, Binding::conjunction},
    {"and", Binding::conjunction, Binding::conjunction, Binding::negation},
    {"<", Binding::comparison, Binding::sum, Binding::sum},
    {"<=", Binding::comparison, Binding::sum, Binding::sum},
    {">", Binding::comparison, Binding::sum, Binding::sum},
    {">=", Binding::comparison, Binding::sum, Binding::sum},
    {"==", Binding::comparison, Binding::sum, Binding::sum},
    {"!=", Binding::comparison, Binding::sum, Binding::sum},
    {"+", Binding::sum, Binding::sum, Binding::product},
    {"-", Binding::sum, Binding::sum, Binding::product},
    {"*", Binding::product, Binding::product, Binding::sign},
    {"/", Binding::product, Binding::product, Binding::sign},
    {"^", Binding::power, Binding::primary, Binding::sign},
}};

struct BindingOf {
  Binding operator()(ast::Number const& number) const { return std::signbit(number.value) ? Binding::sign : Binding::primary; }
  Binding operator()(ast::Text const&) const { return Binding::primary; }
  Binding operator()(ast::Reference const&) const { return Binding::primary; }
  Binding operator()(ast::Box<ast::Unary> const& unary) const { return unary->symbol == "not" ? Binding::negation : Binding::sign; }
  Binding operator()(ast::Box<ast::Binary> const& binary) const { return operator_row(binary->symbol).binding; }
  Binding operator()(ast::Box<ast::Call> const&) const { return Binding::primary; }
  Binding operator()(ast::Box<ast::Conditional> const&) const { return Binding::conditional; }
  Binding operator()(ast::Box<ast::List> const&) const { return Binding::primary; }
};

}  // namespace

OperatorRow const& operator_row(std::string_view symbol) {
  for (OperatorRow const& row : operators)
    if (row.symbol == symbol) return row;
  throw InternalError(fmt::format("no operator `{}` to print", symbol));
}

Binding binding(ast::Expression const& expression) { return std::visit(BindingOf{}, expression.node); }

}  // namespace sysid
