// Every message about a data file's contents (E40), one named constructor per mistake; wording lives in errors.cpp alone.
#pragma once
#include <cstddef>
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
  int row = 0;
  int line = 0;
  std::string column;
};

// the file as a table
Diagnostic no_header(std::string const& file, Mention mention);
Diagnostic header_of_numbers(std::string const& file, int line, bool after_comment, Mention mention);
/// proposed: the advice that reads it in another encoding, where one does.
Diagnostic not_text(std::string const& file, std::optional<std::string> const& proposed, Mention mention);
Diagnostic not_in_encoding(std::string const& file, std::string const& encoding, Mention mention);
/// E4008 of a file of variables; known: those that are columns.
Diagnostic missing_variable(std::string const& file, std::string const& variable, std::vector<std::string> const& known,
                            Mention mention);
/// E4027. reason: "is complex".
Diagnostic no_column_of_numbers(std::string const& file, std::string const& variable, std::string const& reason,
                                std::vector<std::string> const& known, Mention mention);
/// A file of a kind that is known, and is not read. what: "a spreadsheet".
Diagnostic not_a_record(std::string const& file, std::string_view what, std::string_view help, Mention mention);
/// E4025: `read` says how text is written. what: "MATLAB file".
Diagnostic reading_of_no_text(std::string const& file, std::string_view what, Mention mention);
/// E4025: a mark of missing samples that no number is. what: "MATLAB file".
Diagnostic word_among_numbers(std::string const& file, std::string_view what, std::string const& word, Mention mention);
/// E4023. what: "gzip file".
/// what: "MATLAB file"; the process that reads it waits for ever.
Diagnostic reading_waited(std::string const& file, std::string const& what, Mention mention);
/// target: the file that a dataset lies in.
Diagnostic linked_elsewhere(std::string const& file, std::string const& target, Mention mention);
Diagnostic damaged(std::string const& file, std::string const& what, Mention mention);
Diagnostic open_quote(std::string const& file, int line, Mention mention);
Diagnostic ragged_row(std::string const& file, int row, int line, int cells, int columns, Mention mention);
/// E4010: a line between the rows that is none.
Diagnostic broken_table(std::string const& file, int line, Mention mention);
Diagnostic comment_in_data(std::string const& file, int row, int line, Mention mention);
Diagnostic too_many_rows(std::string const& file, int most, Mention mention);
Diagnostic too_few_rows(std::string const& file, int rows, Mention mention);

// what `read` says of a file, and the file does not have
Diagnostic no_such_line(std::string const& file, std::string const& setting, int line, int lines, Mention mention);
Diagnostic other_number_of_columns(std::string const& file, int line, int cells, int names, Mention mention);

// columns and cells
/// quote: whether the names of the file may be shown.
Diagnostic missing_column(std::string const& file, std::string const& column, std::vector<std::string> const& known, bool quote,
                          Mention mention);
Diagnostic repeated_column(std::string const& file, std::string const& column, Mention mention);
/// quote: whether the cell may be shown.
Diagnostic not_a_number(Cell const& cell, std::string_view text, bool quote, Mention mention);
/// E4010: text in each cell of the first row: the units, as some programs write them.
Diagnostic row_of_units(Cell const& cell, std::string_view text, Mention mention);
/// E4002: `sep=|`.
Diagnostic unknown_separator(std::string const& file, int line, std::string_view separator, Mention mention);
Diagnostic not_finite(Cell const& cell, std::string_view text, Mention mention);
Diagnostic out_of_range(Cell const& cell, std::string_view text, Mention mention);
/// what: "an input" or "the time".
/// Digits of `text` after its point may be a group of three.
Diagnostic points_or_groups(Cell const& cell, std::string_view text, Mention mention);
/// value: as the file writes it.
Diagnostic doubtful_sample(Cell const& cell, std::string const& value, int times, Mention mention);
/// text: empty where it may not be shown.
/// word: what `stamp` would say of them. is_text: `read` can be said of the file.
Diagnostic times_are_dates(Cell const& cell, double value, std::string_view word, bool is_text, Mention mention);
/// A date or a time of day below numbers.
Diagnostic stamp_among_numbers(Cell const& cell, std::string_view text, Mention mention);
/// `115958, 115959, 120000`: a time of day as one number. patterns: of `stamp`, those that may be meant.
Diagnostic times_are_clock(Cell const& cell, double before, double now, std::vector<std::string> const& patterns, bool is_text,
                           Mention mention);
Diagnostic times_are_counts(Cell const& cell, Mention mention);
/// E4024. has_zone: the cell, and not the first one; or the other way about.
Diagnostic zones_differ(Cell const& cell, std::string_view text, bool has_zone, Mention mention);
/// E4024. `10:00:00:7` below `10:00:00:07`.
Diagnostic fractions_differ(Cell const& cell, std::string_view text, Mention mention);
Diagnostic not_a_stamp(Cell const& cell, std::string_view text, std::string const& pattern, Mention mention);
/// E4026. stated: in the data block; found: in the file.
Diagnostic unit_differs(std::string const& file, std::string const& column, std::string const& stated, std::string const& found,
                        Mention mention);
/// Such as `F [kN]`, a name with its unit.
struct NamedUnit {
  std::string column, bare;
};
struct TwoUnits {
  std::string stated, found;  // in the data block, in the file
  std::string to_write{};     // what the data block should have for `found`; empty: the same
};
/// E4026. is_text: `read` can be said of the file.
Diagnostic unit_differs_from_name(std::string const& file, NamedUnit const& name, TwoUnits const& units, bool is_text,
                                  Mention mention);
Diagnostic unit_unknown(std::string const& file, std::string const& column, std::string const& found, Mention mention);
Diagnostic unit_of_another_kind(std::string const& file, std::string const& column, std::string const& found,
                                std::string const& wanted, Mention mention);
Diagnostic missing_value(Cell const& cell, std::string const& what, Mention mention);
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
/// E4013 of an input of a model whose rows are independent.
Diagnostic gap_in_independent_rows(Cell const& first, int last, Mention mention);
/// E4013 of an input, in rows that a run uses.
Diagnostic gap_in_input(Cell const& first, GapEnd const& end, SimulatedRows const& rows, FreeRows const& free, Mention mention);

Diagnostic not_a_count(Cell const& cell, double value, Mention mention);

// the columns as a record
/// E4028
Diagnostic unequal_lengths(std::string const& file, std::string const& a, std::size_t rows_a, std::string const& b,
                           std::size_t rows_b, Mention mention);
Diagnostic time_not_increasing(Cell const& cell, double before, double now, Mention mention);
Diagnostic unequal_steps(int row, double step, double usual, Mention mention);
/// what: "range `train`".
Diagnostic rows_outside(std::string const& file, std::string const& what, int first, int last, int rows, Mention mention);
Diagnostic cycles_against_radians(std::string const& column, std::string const& column_unit, std::string const& declared_unit,
                                  Mention mention);

}  // namespace sysid::data_errors
