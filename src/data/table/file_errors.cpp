#include "data/table/file_errors.hpp"

#include <fmt/format.h>

#include "core/text/words.hpp"

namespace sysid::data_errors {
namespace {

std::string columns_there_are(std::vector<std::string> const& known) {
  return known.empty() ? "it has no vectors of numbers" : fmt::format("its vectors of numbers are {}", column_names(known));
}

}  // namespace

Diagnostic no_header(std::string const& file, Mention mention) {
  return error("E4001", mention, fmt::format("`{}` is empty", file),
               "the first line must name the columns, for example `t,force,y`");
}

Diagnostic header_of_numbers(std::string const& file, int line, bool after_comment, Mention mention) {
  return error("E4002", mention, fmt::format("line {} of `{}` should name the columns but begins with a number", line, file),
               after_comment ? "lines that begin with `#` are comments: name the columns on a line without `#`"
                             : "put a line with the names of the columns above the numbers");
}

Diagnostic not_text(std::string const& file, std::optional<std::string> const& proposed, Mention mention) {
  return error("E4003", mention, fmt::format("`{}` is not UTF-8 text", file),
               proposed ? *proposed : "records are text, MATLAB files (.mat), NetCDF and HDF5; save a spreadsheet as CSV");
}

Diagnostic nul_bytes(std::string const& file, std::int64_t line, std::size_t count, Mention mention) {
  return error("E4003", mention,
               fmt::format("`{}` has {} among its text, {} in line {}", file, counted(count, "NUL byte"),
                           count == 1 ? "it is" : "the first", line),
               "delete them and the line that they cut, if there is one: a recorder that loses power leaves them in place of the "
               "last rows");
}

Diagnostic not_in_encoding(std::string const& file, std::string const& encoding, Mention mention) {
  return error("E4003", mention, fmt::format("`{}` is not text in {}", file, encoding),
               "remove `encoding` from the data block if the file is in UTF-8");
}

Diagnostic missing_variable(std::string const& file, std::string const& variable, std::vector<std::string> const& known,
                            Mention mention) {
  std::string const guess = did_you_mean(variable, known);
  return error("E4008", mention, fmt::format("`{}` has no variable `{}`", file, variable),
               guess + (guess.empty() ? "" : " ") + columns_there_are(known));
}

Diagnostic no_column_of_numbers(std::string const& file, std::string const& variable, std::string const& reason,
                                std::vector<std::string> const& known, Mention mention) {
  return error("E4027", mention, fmt::format("`{}` of `{}` {}", shown(variable), file, reason), columns_there_are(known));
}

Diagnostic not_a_record(std::string const& file, std::string_view what, std::string_view help, Mention mention) {
  return error("E4003", mention, fmt::format("`{}` is {}, which is not read", file, what), std::string(help));
}

Diagnostic reading_of_no_text(std::string const& file, std::string_view what, Mention mention) {
  return error("E4025", mention, fmt::format("`{}` is a {}, for which `missing` is the only setting of `read`", file, what),
               "remove `read` from the data block, or all its settings except `missing`");
}

Diagnostic word_among_numbers(std::string const& file, std::string_view what, std::string const& word, Mention mention) {
  return error("E4025", mention,
               fmt::format("`missing` lists `{}`, but columns of `{}`, a {}, have numbers only", shown(word), file, what),
               "list the number that marks a missing sample in this file, or remove the word: NaN is a missing sample anyway");
}

Diagnostic damaged(std::string const& file, std::string const& what, Mention mention) {
  return error("E4023", mention, fmt::format("`{}` is damaged, or not a {}", file, what),
               "copy it again from where it was recorded; a file that is still being written can be read later");
}

Diagnostic reading_waited(std::string const& file, std::string const& what, Mention mention) {
  return error("E4023", mention, fmt::format("`{}` could not be read as a {}: the process that reads it hangs", file, what),
               "run the command again; if that does not help, the file may be damaged: copy it again, or save it as CSV");
}

Diagnostic linked_elsewhere(std::string const& file, std::string const& target, Mention mention) {
  return error("E4023", mention,
               fmt::format("`{}` has a link to another file, `{}`, and links are not followed", file, shown(target)),
               "copy the data into this file: `h5copy`, or `h5repack --merge`; or name the other file in the data block");
}

Diagnostic unknown_separator(std::string const& file, int line, std::string_view separator, Mention mention) {
  return error("E4002", mention,
               fmt::format("line {} of `{}` declares the separator `{}`, which is not supported", line, file, shown(separator)),
               "separate the columns by commas, semicolons or tabs");
}

Diagnostic open_quote(std::string const& file, std::int64_t line, Mention mention) {
  return error("E4004", mention, fmt::format("a quoted cell is not closed correctly on line {} of `{}`", line, file),
               "close it with `\"` on the same line, followed by a separator; a quote inside is written `\"\"`");
}

Diagnostic cut_row(std::string const& file, int row, int line, int cells, int columns, Mention mention) {
  return error("E4005", mention,
               fmt::format("{} has {}, but the header names {}: the file ends within this line", place(file, row, line),
                           counted(cells, "cell"), counted(columns, "column")),
               "delete this line");
}

Diagnostic ragged_row(std::string const& file, std::int64_t row, std::int64_t line, int cells, int columns, Mention mention) {
  return error(
      "E4005", mention,
      fmt::format("{} has {}, but the header names {}", place(file, row, line), counted(cells, "cell"), counted(columns, "column")),
      cells > columns
          ? "remove the cell that is too many; numbers with a decimal comma need a separator other than the comma: export "
            "the file again with `;`"
          : "a missing value is an empty cell between separators");
}

Diagnostic broken_table(std::string const& file, int line, Mention mention) {
  return error("E4010", mention,
               fmt::format("line {} of `{}` is not a row of values, unlike the lines above and below it", line, file),
               "correct the line or delete it; to read only the lines before it or after it, state them with `read values`");
}

Diagnostic comment_in_data(std::string const& file, std::int64_t row, std::int64_t line, Mention mention) {
  return error("E4006", mention, fmt::format("{} is a comment", place(file, row, line)),
               "comments are allowed only above the header");
}

Diagnostic too_many_rows(std::string const& file, int most, Mention mention) {
  return error("E4020", mention, fmt::format("`{}` has more than {} rows", file, most), "cut the record into several files");
}

Diagnostic too_few_rows(std::string const& file, int rows, int fewest, Mention mention) {
  return error("E4007", mention, fmt::format("`{}` has {}", file, rows == 0 ? "no rows" : counted(rows, "row")),
               fmt::format("a record needs at least {}", counted(fewest, "row")));
}

Diagnostic no_such_line(std::string const& file, std::string const& setting, int line, int lines, Mention mention) {
  return error("E4025", mention,
               fmt::format("`{} = {}`: there is no such line above the values of `{}` ({} looked at)", setting, line, file,
                           lines == 1 ? "1 line was" : fmt::format("{} lines were", lines)),
               "lines are counted from 1 at the top of the file, with empty ones and comments");
}

Diagnostic other_number_of_columns(std::string const& file, int line, int cells, int names, Mention mention) {
  return error("E4025", mention,
               fmt::format("line {} of `{}` has {}, but `columns` names {}", line, file, counted(cells, "cell"), names),
               "name all columns, also those that are not used");
}

Diagnostic unequal_lengths(std::string const& file, std::string const& a, std::size_t rows_a, std::string const& b,
                           std::size_t rows_b, Mention mention) {
  return error(
      "E4028", mention,
      fmt::format("`{}` has {} numbers and `{}` has {} in `{}`: they cannot be columns of one record", b, rows_b, a, rows_a, file),
      "give each of them a data block and a time of its own, or resample them to the same times first");
}

Diagnostic rows_outside(std::string const& file, std::string const& what, int first, int last, int rows, Mention mention) {
  return error("E4016", mention,
               fmt::format("{} selects rows {}..{}, but `{}` has {}", what, first, last, file, counted(rows, "row")),
               fmt::format("rows are numbered from 1 below the header; the last is {}", rows));
}

}  // namespace sysid::data_errors
