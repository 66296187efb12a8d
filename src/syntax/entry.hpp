// Text as it is typed: whether a statement goes on, where one ends and the next begins. Implemented in grammar/, which finds
// tokens.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "core/text/source.hpp"

namespace sysid {

/// Whether the last statement goes on in the next line: a bracket or brace is open, or the line ends in what no statement ends in.
bool unfinished(std::string_view text);

/// The statements that stand directly in a text, blocks whole, in its order; comments and `;` between them belong to none.
std::vector<Span> top_level_statements(std::string_view text);

/// The same statements in one line, without comments: `model a { input x; state y }`.
std::string in_one_line(std::string_view text);

}  // namespace sysid
