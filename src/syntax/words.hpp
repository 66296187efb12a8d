// The words of the language, one table per place where they may stand. All but `reserved` are contextual: the user may use them as
// names. A later statement, verb or item adds its word here, its rule in grammar/ and its line in grammar/sysid.ebnf.
#pragma once
#include <algorithm>
#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

/// In the order of words::verbs.
enum class TaskKind { simulate, fit, select, discover, predict };

}  // namespace sysid

namespace sysid::words {

/// Never names: each could follow or begin an expression.
inline constexpr std::array<std::string_view, 6> reserved{"if", "then", "else", "and", "or", "not"};

/// First words of what stands in a file; a task begins with its verb, or with its name and `=`.
inline constexpr std::array<std::string_view, 6> items{"use", "model", "data", "candidates", "dictionary", "function"};
/// Those with braces.
inline constexpr std::array<std::string_view, 4> blocks{"model", "data", "candidates", "dictionary"};
inline constexpr std::array<std::string_view, 5> verbs{"simulate", "fit", "select", "discover", "predict"};
inline constexpr std::array<std::string_view, 3> prepositions{"to", "on", "from"};
/// Inside a task.
inline constexpr std::array<std::string_view, 2> task_words{"with", "input"};

/// First words of the statements of a model; anything else there is an equation.
inline constexpr std::array<std::string_view, 12> model_statements{
    "time", "input", "state", "disturbance", "initial", "parameter", "constant", "let", "derive", "function", "observe", "part"};
/// Words inside them.
inline constexpr std::array<std::string_view, 3> model_words{"discrete", "per", "experiment"};
/// First words of the statements of a data block, and the words inside them.
inline constexpr std::array<std::string_view, 9> data_statements{"file",  "read",    "time",     "rate", "step",
                                                                 "input", "measure", "constant", "split"};
inline constexpr std::array<std::string_view, 3> data_words{"hold", "error", "rows"};
/// Of a set of candidate models: what begins a statement that is no candidate, and what follows a candidate.
inline constexpr std::array<std::string_view, 2> candidate_words{"shared", "probability"};
/// First words of the statements of a dictionary.
inline constexpr std::array<std::string_view, 11> dictionary_statements{
    "time", "input", "state", "parameter", "constant", "let", "function", "target", "terms", "exclude", "coefficients"};

constexpr bool contains(std::span<std::string_view const> table, std::string_view word) {
  return std::find(table.begin(), table.end(), word) != table.end();
}

/// The kind of a task by the verb that it is written with; nothing for what is no verb.
constexpr std::optional<TaskKind> task_kind(std::string_view verb) {
  for (std::size_t i = 0; i < verbs.size(); ++i)
    if (verbs[i] == verb) return static_cast<TaskKind>(i);
  return std::nullopt;
}

inline std::vector<std::string> list(std::span<std::string_view const> table) { return {table.begin(), table.end()}; }

/// Letters, digits, underscore and every byte of a multi-byte UTF-8 character may be part of a name; a digit may not begin it.
constexpr bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80U;
}
constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }
constexpr bool continues_name(char c) { return begins_name(c) || is_digit(c); }

}  // namespace sysid::words
