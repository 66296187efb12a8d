// Help on every word: of the language, of the prompt, of messages.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sysid::repl {

/// A word of the language that stands in no other table: a keyword or an option of tasks.
struct KeywordRow {
  std::string_view word, usage, summary;
};
std::span<KeywordRow const> keywords();

/// All that is known of a word, in the order command, function of the prompt, keyword, tables of the language, module, message;
/// nothing when no table has it. columns: of the terminal; 0 where there is none.
std::optional<std::string> help_on(std::string const& word, int columns = 0);

/// What `help` prints alone.
std::string help_overview(int columns = 0);

/// Every word that `help_on` knows, but for codes of messages.
std::vector<std::string> const& words_with_help();

}  // namespace sysid::repl
