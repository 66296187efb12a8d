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
    {"..", OperatorBinding::conditional, OperatorBinding::conditional, OperatorBinding::conditional},  // of arguments alone
    {"or", OperatorBinding::disjunction, OperatorBinding::disjunction, OperatorBinding::conjunction},
    {"and", OperatorBinding::conjunction, OperatorBinding::conjunction, OperatorBinding::negation},
    {"<", OperatorBinding::comparison, OperatorBinding::sum, OperatorBinding::sum},
    {"<=", OperatorBinding::comparison, OperatorBinding::sum, OperatorBinding::sum},
    {">", OperatorBinding::comparison, OperatorBinding::sum, OperatorBinding::sum},
    {">=", OperatorBinding::comparison, OperatorBinding::sum, OperatorBinding::sum},
    {"==", OperatorBinding::comparison, OperatorBinding::sum, OperatorBinding::sum},
    {"!=", OperatorBinding::comparison, OperatorBinding::sum, OperatorBinding::sum},
    {"+", OperatorBinding::sum, OperatorBinding::sum, OperatorBinding::product},
    {"-", OperatorBinding::sum, OperatorBinding::sum, OperatorBinding::product},
    {"*", OperatorBinding::product, OperatorBinding::product, OperatorBinding::sign},
    {"/", OperatorBinding::product, OperatorBinding::product, OperatorBinding::sign},
    {"^", OperatorBinding::power, OperatorBinding::primary, OperatorBinding::sign},
}};

struct BindingOf {
  OperatorBinding operator()(ast::Number const& number) const {
    return std::signbit(number.value) ? OperatorBinding::sign : OperatorBinding::primary;
  }
  OperatorBinding operator()(ast::Text const&) const { return OperatorBinding::primary; }
  OperatorBinding operator()(ast::Reference const&) const { return OperatorBinding::primary; }
  OperatorBinding operator()(ast::Box<ast::Unary> const& unary) const {
    return unary->symbol == "not" ? OperatorBinding::negation : OperatorBinding::sign;
  }
  OperatorBinding operator()(ast::Box<ast::Binary> const& binary) const { return operator_row(binary->symbol).binding; }
  OperatorBinding operator()(ast::Box<ast::Call> const&) const { return OperatorBinding::primary; }
  OperatorBinding operator()(ast::Box<ast::Conditional> const&) const { return OperatorBinding::conditional; }
  OperatorBinding operator()(ast::Box<ast::List> const&) const { return OperatorBinding::primary; }
};

}  // namespace

OperatorRow const& operator_row(std::string_view symbol) {
  for (OperatorRow const& row : operators)
    if (row.symbol == symbol) return row;
  throw InternalError(fmt::format("no operator `{}` to print", symbol));
}

OperatorBinding binding(ast::Expression const& expression) { return std::visit(BindingOf{}, expression.node); }

}  // namespace sysid
