// Where blanks stand between the tokens of a statement, and where its lines may end.
#pragma once
#include <span>

#include "grammar/format/pieces.hpp"

namespace sysid::grammar {

/// The pieces of the tokens of one statement, without comments.
std::vector<Piece> spaced(std::span<Token const> tokens);

/// A word that begins a declaration: the next token cannot continue an expression.
bool is_declaration(std::span<Token const> tokens);

/// The columns of a declaration inside a block, or of a task with a name outside; nothing for any other statement.
std::optional<Cells> cells_of(std::span<Token const> tokens, std::span<Piece const> pieces, int level);

}  // namespace sysid::grammar
