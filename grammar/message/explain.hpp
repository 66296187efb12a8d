// From "the rules wanted this, there" to the mistake the user made, and to the place where parsing goes on.
#pragma once
#include <optional>
#include <string>

#include "core/text/diagnostic.hpp"
#include "grammar/message/layout.hpp"

namespace sysid::grammar {

/// Deeper nesting is refused: each level costs a few kilobytes of stack in the parser, less in later stages.
inline constexpr int deepest_nesting = 200;

/// Names of rules that `explain` knows; other rules are named by the noun phrase shown to the user.
namespace wanted {
inline constexpr char const* name = "a name";
inline constexpr char const* column = "a column";
inline constexpr char const* value = "a value";
inline constexpr char const* operator_between = "an operator";
inline constexpr char const* equals = "`=`";
inline constexpr char const* tilde = "`~`";
inline constexpr char const* opening_brace = "`{`";
inline constexpr char const* end_of_statement = "the end of the statement";
inline constexpr char const* preposition_or_end = "`to`, `on`, `from`, `with` or the end of the statement";
inline constexpr char const* with_or_end = "`with` or the end of the statement";
inline constexpr char const* model_statement = "a statement of a model";
inline constexpr char const* data_statement = "a statement of a data block";
inline constexpr char const* candidate_statement = "a candidate model";
inline constexpr char const* dictionary_statement = "a statement of a dictionary";
inline constexpr char const* item = "a model, a data block, candidates, a dictionary, a function or a task";
inline constexpr char const* verb = "a task";
inline constexpr char const* shallower_nesting = "shallower nesting";
}  // namespace wanted

/// The diagnostic for a failure at `where` (a byte offset), or nothing when one is reported there already.
std::optional<Diagnostic> explain(Layout const& layout, std::uint32_t where, std::string const& wanted);

/// The end of the statement of a block in which parsing failed at `where`; braces opened in it are closed.
std::uint32_t behind_statement(Layout const& layout, std::uint32_t where);
/// The end of the item in which parsing failed at `where`, always behind `where` unless at the end of the text.
std::uint32_t behind_item(Layout const& layout, std::uint32_t where, std::string const& wanted);

}  // namespace sysid::grammar
