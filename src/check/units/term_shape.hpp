// What stands in a term, and how: where a unit may be missing, or a fraction upside down.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "syntax/ast.hpp"

namespace sysid {

/// A factor of a product that is a number without a unit; null when there is none.
ast::Expression const* bare_factor(ast::Expression const& tree);

/// All that are read, each as often as it stands there.
std::vector<std::string> names_in(ast::Expression const& tree);

/// Whether it is what somebody measured, and no factor of a formula such as 2, 0.5 or 3/4.
bool is_measured_number(ast::Expression const& tree);

/// Of an expression whose names all stand in its only quotient, and only there: that one as it is written, and turned over: `k/m`
/// and `m/k` of `2*pi*sqrt(k/m)`.
std::optional<std::pair<std::string, std::string>> turned_over(ast::Expression const& tree);

/// How often a name is a factor of a product, -1 below the fraction line; nothing where it stands elsewhere as well, as in a sum.
std::optional<int> factor_power(ast::Expression const& tree, std::string const& name);

}  // namespace sysid
