// What to do about a construct of another language or of paper, told from the tokens around the place where the rules gave up.
#pragma once
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "grammar/message/scan.hpp"

namespace sysid::grammar {

/// One failure: `wanted` there, `found` instead (absent at the end of a line); `statement` is what the user wrote from its first
/// token to the last of the statement, and `at` the index in it of what was found.
struct Gap {
  std::string_view wanted;
  Token const* found = nullptr;
  std::span<Token const> statement;
  std::size_t at = 0;
  std::vector<std::string_view> names = {};  // that the file declares; given where an operator is missing

  Token const* before(std::size_t steps = 1) const {
    return at >= steps && at - steps < statement.size() ? &statement[at - steps] : nullptr;
  }
  bool begins_with(std::string_view word) const { return !statement.empty() && statement[0].is(word); }
  bool found_is(std::string_view text) const { return found != nullptr && found->is(text); }
  bool declares(std::string_view name) const { return std::find(names.begin(), names.end(), name) != names.end(); }
  bool found_word() const { return found != nullptr && found->kind == TokenKind::word; }
  Token const* next(std::size_t steps = 1) const {
    return found != nullptr && at + steps < statement.size() ? &statement[at + steps] : nullptr;
  }
  /// Index of the first such symbol from `from` on, or the size of the statement.
  std::size_t find(std::string_view symbol, std::size_t from = 0) const;
  /// What the user wrote from one token up to another, exclusively; empty where there is nothing.
  std::string_view text(std::size_t from, std::size_t end) const;
  std::string_view rest() const { return text(at, statement.size() - (!statement.empty() && statement.back().is(";") ? 1 : 0)); }
  /// The bracket that closes the one at `opener`, or the size of the statement.
  std::size_t closing(std::size_t opener) const;
};

/// What the user wrote from one token to a later one.
std::string_view written(Token const& first, Token const& last);

/// One past the last of the tokens from `from` on that are a unit on paper, `N s/m^2`; `from` where there is none.
std::size_t end_of_unit(std::span<Token const> statement, std::size_t from);

/// Help about statements of a model, about those of the other blocks and tasks, and among these of a data block; empty where
/// nothing is known.
std::string hint_in_model(Gap const& gap);
std::string hint_in_block(Gap const& gap);
std::string hint_in_data(Gap const& gap);
/// What is meant by a statement of a data block that begins with another word; empty where nothing is known.
std::string instead_of_data_statement(Gap const& gap);

/// `[N/mm]` where the words of a unit were found without brackets, or empty.
std::string unit_without_brackets(Gap const& gap);

/// Two values without an operator that are no product on paper: "a unit is written in brackets: `9.81 [m/s^2]`", or empty.
std::string instead_of_product(Gap const& gap);

/// The `]` behind the `[` at `opener`, before its line ends and before anything that stands in no list; else how many tokens there
/// are.
std::size_t closing_on_line(std::span<Token const> tokens, std::size_t opener);
/// "`~ uniform(1, 100)`" of the numbers between two brackets.
std::string list_as_range(std::span<Token const> tokens, std::size_t opener, std::size_t close);
/// What is written in place of the list in brackets at `opener`; `line`: the first token of its line.
std::string instead_of_list(std::span<Token const> tokens, std::size_t line, std::size_t opener);

/// The comma of a call from one token on, or what closes the call: not one of a call inside.
std::size_t comma_from(Gap const& gap, std::size_t at, std::size_t close);

/// How `~ pm.Normal(0, 1)` is written, at the module. Of `Normal("k", 0, 1)` at its parenthesis the call alone: without arguments
/// where a valid call is not known, "..." where the distribution is not.
std::string distribution_of_module(Gap const& gap);
std::string call_of_module(Gap const& gap, std::size_t opener);

/// What is written in place of `parameters { ... }` inside a model, of its word; empty for words that begin no block elsewhere.
std::string instead_of_inner_block(std::string_view word);

/// Help for the user, or empty.
std::string hint(Gap const& gap);

}  // namespace sysid::grammar
