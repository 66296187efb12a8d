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

/// What the user wrote from one token to a later one.
std::string_view written(Token const& first, Token const& last);

/// `[N/mm]` where the words of a unit were found without brackets, or empty.
std::string unit_without_brackets(Gap const& gap);

/// Two values without an operator that are no product on paper: "a unit is written in brackets: `9.81 [m/s^2]`", or empty.
std::string instead_of_product(Gap const& gap);

/// Help for the user, or empty.
std::string hint(Gap const& gap);

}  // namespace sysid::grammar
