// What may stand at a place of a text: keywords, names in scope, words of the language, columns, files.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "core/text/source.hpp"
#include "load/modules.hpp"

namespace sysid::assist {

enum class CompletionKind { keyword, name, function, word, setting, choice, column, file, module, unit };

struct Completion {
  std::string label;  // as it is written
  CompletionKind kind = CompletionKind::keyword;
  std::string detail;   // what it is, or its signature; may be empty
  std::string summary;  // one line; may be empty
};

struct Completions {
  Span replaces;                  // what is written of the word already, up to the place
  std::vector<Completion> items;  // all that may stand there, whatever is written already; each label once
};

/// path: of the text, for modules and data beside it; offset: in bytes. Nothing in comments.
Completions complete(std::string const& path, std::string const& text, std::uint32_t offset, UnsavedText const& unsaved = {});

}  // namespace sysid::assist
