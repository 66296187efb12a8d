// A wrong unit in a declaration causes a conflict at each use of the name: it is reported once, at the declaration.
#pragma once
#include <cstddef>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Looks for the one declaration of `model` in whose place another unit resolves two or more of the conflicts between units among
/// the messages from `first` on, and makes no new one: of those the first is kept, and names the declaration and that unit. Where
/// no declaration does so, or more than one, nothing is changed; nor in a model of more than 200 statements, for the time it would
/// take.
void blame_declaration(ast::Model const& model, std::vector<ast::FunctionDefinition const*> const& shared, std::size_t first,
                       Diagnostics& diagnostics);

}  // namespace sysid
