// Neighbouring declarations and tasks as tables.
#pragma once
#include <span>

#include "grammar/format/pieces.hpp"

namespace sysid::grammar {

/// Sets the padding of pieces: in a run of declarations (no empty line, no other statement between them) the names stand in one
/// column, and in a stretch of the same keyword the units and the signs `~` and `=` do.
void align(std::span<Item> items);

}  // namespace sysid::grammar
