// Files that somebody takes for a .sysid file by mistake.
#pragma once
#include <string_view>

namespace sysid {

/// Whether the lines of a text end in CR alone: a comment would hold all that follows it.
bool ends_lines_by_return(std::string_view text);

/// What a text that cannot be read as statements looks like: "a table of numbers (CSV)", "a spreadsheet or another ZIP archive";
/// empty where it is no file of a known other kind.
std::string_view other_kind(std::string_view text);

}  // namespace sysid
