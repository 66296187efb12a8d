// A text with syntax errors is checked as far as it can be read; this determines which messages are reliable.
#pragma once
#include <span>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Of what was found in `tree`, keeps the errors on which the parts of the text that could not be read have no bearing: whatever
/// may be declared, determined or bound there is not missed. tree, unread: of `parse_readable`.
void keep_independent(ast::File const& tree, std::span<Span const> unread, Source const& source, Diagnostics& found);

}  // namespace sysid
