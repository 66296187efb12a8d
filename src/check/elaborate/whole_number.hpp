// Whole numbers known when a model is used: its arguments, sizes, indices, and exponents of units made of them.
#pragma once
#include <map>
#include <optional>
#include <string>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Arguments of a model by name.
using WholeNumbers = std::map<std::string, long>;

/// Sums, products, powers and quotients of whole numbers and names of `known`; nothing where it is no whole number below 10^9.
std::optional<long> whole_number(ast::Expression const& expression, WholeNumbers const& known);

/// The unit with arguments of the model in exponents put in: `[N^(1-n)/m]` is `[N^-1/m]` for n = 2.
ast::UnitExpression with_arguments(ast::UnitExpression unit, WholeNumbers const& known);
std::optional<ast::UnitExpression> with_arguments(std::optional<ast::UnitExpression> unit, WholeNumbers const& known);

}  // namespace sysid
