// Errors of columns and cells of a data file (E40). One named constructor per mistake.
#pragma once
#include <string>
#include <string_view>
#include <vector>

#include "data/table/error_parts.hpp"

namespace sysid::data_errors {

/// quote: whether the names of the file may be shown.
Diagnostic missing_column(std::string const& file, std::string const& column, std::vector<std::string> const& known, bool quote,
                          Mention mention);
Diagnostic repeated_column(std::string const& file, std::string const& column, Mention mention);
/// quote: whether the cell may be shown.
Diagnostic not_a_number(Cell const& cell, std::string_view text, bool quote, Mention mention);
/// E4010: text in each cell of the first row: the units, as some programs write them.
Diagnostic row_of_units(Cell const& cell, std::string_view text, Mention mention);
Diagnostic not_finite(Cell const& cell, std::string_view text, Mention mention);
Diagnostic out_of_range(Cell const& cell, std::string_view text, Mention mention);
Diagnostic not_a_count(Cell const& cell, double value, Mention mention);
/// E4021: digits of `text` after its point may be a group of three.
Diagnostic points_or_groups(Cell const& cell, std::string_view text, Mention mention);
/// value: as the file writes it.
Diagnostic doubtful_sample(Cell const& cell, std::string const& value, int times, Mention mention);
/// what: "an input" or "the time".
Diagnostic missing_value(Cell const& cell, std::string const& what, Mention mention);
/// E4013 of an input of a model whose rows are independent.
Diagnostic gap_in_independent_rows(Cell const& first, int last, Mention mention);
/// Where a gap of an input ends, and the numbers around it; NaN at an end of the record.
struct GapEnd {
  int last = 0;
  double before = 0, after = 0;
};
/// around: rows to either side that the input's rule reads.
struct SimulatedRows {
  int first = 0, last = 0, around = 0;
};
/// The longest stretch of them without a gap; last <= first: none.
struct FreeRows {
  int first = 0, last = 0;
};
/// E4013 of an input, in rows that a run uses.
Diagnostic gap_in_input(Cell const& first, GapEnd const& end, SimulatedRows const& rows, FreeRows const& free, Mention mention);

}  // namespace sysid::data_errors
