// Text to syntax tree. Implemented in grammar/, the only folder that includes Boost.Spirit.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// More is refused: what is written by hand stays far below, and all that the stages do is bounded by it.
inline constexpr std::size_t most_text_bytes = 1'000'000;

/// The tree of a whole file, or nothing when anything was reported. Up to 20 independent syntax errors (E1...); never throws on any
/// bytes.
std::optional<ast::File> parse(Source const& source, Diagnostics& diagnostics);

/// A file as far as it can be read. Where anything was reported, the statements and items that hold a mistake are left out of the
/// tree, and `unread` has their places, in any order; nothing can be read where a block does not end.
struct ReadableFile {
  std::optional<ast::File> tree;
  std::vector<Span> unread;
};
ReadableFile parse_readable(Source const& source, Diagnostics& diagnostics);

/// One expression alone, for tests and for the command line (`--set k=1e4 [N/m]`).
std::optional<ast::Expression> parse_expression(Source const& source, Diagnostics& diagnostics);

}  // namespace sysid
