// Expressions at the prompt.
#pragma once
#include <optional>
#include <string>

#include "repl/context.hpp"
#include "syntax/ast.hpp"

namespace sysid::repl {

/// Answers an expression over results: a number, a summary of many, or a plot. text: of the entry, for messages.
bool answer(Context& context, ast::Expression const& tree, std::string const& text);

/// The measured columns of the data block `bench`, of its range `bench.train`, or the column of `bench.CHANNEL`, against time, as
/// its file has them. Nothing where no data block is called so. UserError and IoError where they cannot be read.
std::optional<std::string> plot_columns(Context const& context, std::string const& name, Span span);

}  // namespace sysid::repl
