// What a name is, in a few lines of Markdown.
#pragma once
#include <optional>
#include <string>

#include "assist/analysis.hpp"

namespace sysid::assist {

struct Hover {
  Span span;             // of the name
  std::string markdown;  // the declaration as written, what it is, its unit; of a word of the language its signature and summary
};

/// Nothing where no name stands.
std::optional<Hover> hover(Reading const& reading, std::uint32_t offset);

}  // namespace sysid::assist
