// Letters that are a unit of temperature on paper and another unit here: [C], [F].
#pragma once
#include <cstddef>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Reads [C] as [degC], and [F] as [degF]. Where that resolves conflicts between units among the messages from `first` on, and
/// makes no new one, the first of those is kept, with what the letter is and what was meant; else nothing is changed.
void blame_letters(ast::Model const& model, std::vector<ast::FunctionDefinition const*> const& shared, std::size_t first,
                   Diagnostics& diagnostics);

}  // namespace sysid
