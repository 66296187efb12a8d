// What messages about a data file's contents are made of. Messages are lower case without a full stop; `help` states what to do.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/diagnostic.hpp"

namespace sysid::data_errors {

/// Where the user's text mentions the column, file or split; nothing when no text does.
using Mention = std::optional<Span>;

/// A cell of a data file. Rows count from 1 below the header, lines from 1 at the top of the file; 0: no file of lines.
struct Cell {
  std::string file;
  std::int64_t row = 0;
  std::int64_t line = 0;
  std::string column;
};

Diagnostic error(std::string code, Mention mention, std::string message, std::string help);

/// "`bench.csv` row 3 (line 4)"
std::string place(std::string const& file, std::int64_t row, std::int64_t line);
/// The same with the column.
std::string place(Cell const& cell);

/// A cell may hold anything: shown without control characters and not at any length.
std::string shown(std::string_view text);

/// The first twenty, marked and listed.
std::string column_names(std::vector<std::string> const& names);

/// What stands there as a unit of the language, where it is one; else empty. A model of unknown origin may name any file as data,
/// so what is no unit is not repeated.
std::string as_unit(std::string_view text);

}  // namespace sysid::data_errors
