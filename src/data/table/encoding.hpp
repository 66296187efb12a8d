// Bytes of a text file to UTF-8.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "data/table/reading_rules.hpp"

namespace sysid {

/// Well-formed UTF-8 (Unicode 15, table 3-7) without NUL.
bool is_utf8(std::string_view text);

/// Whether the bytes begin with the mark that UTF-16 files have.
bool has_utf16_mark(std::string_view bytes);

/// The encoding that the bytes seem to have, where they are no UTF-8: nothing where they look like no text at all.
std::optional<Encoding> likely_encoding(std::string_view bytes);

/// In UTF-8, without a mark; nothing where the bytes are not so encoded. A UTF-16 mark is believed whatever `encoding` says.
std::optional<std::string> to_utf8(std::string bytes, Encoding encoding);

}  // namespace sysid
