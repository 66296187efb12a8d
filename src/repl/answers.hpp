// Expressions at the prompt.
#pragma once
#include <string>

#include "repl/context.hpp"
#include "syntax/ast.hpp"

namespace sysid::repl {

/// Answers an expression over results: a number, a summary of many, or a plot. text: of the entry, for messages.
bool answer(Context& context, ast::Expression const& tree, std::string const& text);

}  // namespace sysid::repl
