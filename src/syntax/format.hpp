// One canonical layout for a text of the language, by its tokens: spelling, parentheses and comments stay the user's. Implemented
// in grammar/, which finds tokens and comments.
#pragma once
#include <optional>
#include <string>

#include "core/text/diagnostic.hpp"

namespace sysid {

/// The text in canonical layout, or nothing when it has syntax errors, which are reported. The result has the same tokens (but for
/// `;`), the same comments in the same order and the same syntax tree, and is its own canonical layout. What is decided:
///   one statement a line, two blanks a level of braces; groups of statements stay apart by one empty line; blocks stand apart;
///   neighbouring declarations form a table of keyword, name, unit and `~` or `=`; neighbouring tasks align their `=`;
///   lines longer than 100 characters end behind commas or before operators, continuations are indented by four;
///   comments behind statements stand two blanks behind them, in one column when neighbours have them.
std::optional<std::string> formatted(Source const& source, Diagnostics& diagnostics);

}  // namespace sysid
