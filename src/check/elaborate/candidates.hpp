// A candidate with ranges or lists among its arguments to those of the models it stands for.
#pragma once
#include <optional>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// `n = 1..4` and `n = (1, 3)` are four and two numbers; several such arguments give their product, the last running fastest.
/// Nothing when a diagnostic was added.
std::optional<std::vector<std::vector<ast::Argument>>> expanded(std::vector<ast::Argument> const& arguments,
                                                                Diagnostics& diagnostics);

}  // namespace sysid
