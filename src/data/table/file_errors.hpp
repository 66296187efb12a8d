// Errors of a data file as a table (E40). One named constructor per mistake.
#pragma once
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "data/table/error_parts.hpp"

namespace sysid::data_errors {

Diagnostic no_header(std::string const& file, Mention mention);
Diagnostic header_of_numbers(std::string const& file, int line, bool after_comment, Mention mention);
/// proposed: the advice that reads it in another encoding, where one does.
Diagnostic not_text(std::string const& file, std::optional<std::string> const& proposed, Mention mention);
/// E4003: text but for zeros, the first of them in `line`, from 1.
Diagnostic nul_bytes(std::string const& file, std::int64_t line, std::size_t count, Mention mention);
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
Diagnostic damaged(std::string const& file, std::string const& what, Mention mention);
/// E4023: the process that reads it waits for ever. what: "MATLAB file".
Diagnostic reading_waited(std::string const& file, std::string const& what, Mention mention);
/// E4023. target: the file that a dataset lies in.
Diagnostic linked_elsewhere(std::string const& file, std::string const& target, Mention mention);
/// E4002: `sep=|`.
Diagnostic unknown_separator(std::string const& file, int line, std::string_view separator, Mention mention);
Diagnostic open_quote(std::string const& file, std::int64_t line, Mention mention);
Diagnostic ragged_row(std::string const& file, std::int64_t row, std::int64_t line, int cells, int columns, Mention mention);
/// E4005 of the last line of a file, which has no end of a line.
Diagnostic cut_row(std::string const& file, int row, int line, int cells, int columns, Mention mention);
/// E4010: a line between the rows that is none.
Diagnostic broken_table(std::string const& file, int line, Mention mention);
Diagnostic comment_in_data(std::string const& file, std::int64_t row, std::int64_t line, Mention mention);
Diagnostic too_many_rows(std::string const& file, int most, Mention mention);
Diagnostic too_few_rows(std::string const& file, int rows, int fewest, Mention mention);
/// E4025: what `read` says of a file, and the file does not have.
Diagnostic no_such_line(std::string const& file, std::string const& setting, int line, int lines, Mention mention);
Diagnostic other_number_of_columns(std::string const& file, int line, int cells, int names, Mention mention);
/// E4028
Diagnostic unequal_lengths(std::string const& file, std::string const& a, std::size_t rows_a, std::string const& b,
                           std::size_t rows_b, Mention mention);
/// what: "range `train`".
Diagnostic rows_outside(std::string const& file, std::string const& what, int first, int last, int rows, Mention mention);

}  // namespace sysid::data_errors
