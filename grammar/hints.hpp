// What to do about a construct of another language or of paper, told from the tokens around the place where the rules gave up.
#pragma once
#include <span>
#include <string>

#include "grammar/scan.hpp"

namespace sysid::grammar {

/// One failure: `wanted` there, `found` instead (absent at the end of a line); `statement` is what the user wrote from its first
/// token to the last of the statement, and `at` the index in it of what was found.
struct Gap {
  std::string_view wanted;
  Token const* found = nullptr;
  std::span<Token const> statement;
  std::size_t at = 0;

  Token const* before(std::size_t steps = 1) const {
    return at >= steps && at - steps < statement.size() ? &statement[at - steps] : nullptr;
  }
  bool begins_with(std::string_view word) const { return !statement.empty() && statement[0].is(word); }
};

/// Help for the user, or empty.
std::string hint(Gap const& gap);

}  // namespace sysid::grammar
