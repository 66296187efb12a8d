// What an entry at the prompt is made of: statements of a file, of a model or of a data block, and expressions, told apart by the
// rules of the language itself.
#pragma once
#include <string>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid::repl {

struct EntryPart {
  enum class Kind { items, model_statement, data_statement, expression };
  Kind kind = Kind::items;
  Span span;  // in the entry
};

/// The parts of an entry in order; nothing, with diagnostics whose places are in the entry, when one of them does not parse.
std::vector<EntryPart> parts_of(std::string const& entry, Diagnostics& diagnostics);

/// The one statement of a text that is a part of that kind. Its places are those in the text, all `model_frame` or `data_frame` too
/// high.
ast::ModelStatement model_statement_of(std::string const& text);
ast::DataStatement data_statement_of(std::string const& text);
inline constexpr std::uint32_t model_frame = 10, data_frame = 9;

/// The diagnostic with all its places moved by `by`, those before 0 to 0, those beyond `end` to it.
Diagnostic moved(Diagnostic diagnostic, std::int64_t by, std::uint32_t end);

}  // namespace sysid::repl
