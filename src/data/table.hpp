// A data file as a table of named columns: strict CSV, so that a wrong file is an error naming its row and column, never a wrong
// number.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/source.hpp"

namespace sysid {

/// Comma, semicolon or tab separated, whichever divides the header most often; one header line with the names (quoted or not),
/// before it any number of empty lines and of comment lines that begin with `#`, and as the first line of all `sep=;`. Line ends
/// LF, CRLF or CR; a UTF-8 byte order mark is skipped. Cells are kept as text: only columns that are asked for need to hold
/// numbers.
class Table {
 public:
  /// IoError when the file cannot be read, UserError (at `mention`) when it is no such table. shown_path: what messages name in
  /// place of the path; empty: the path.
  static Table read(std::string const& path, std::optional<Span> mention = std::nullopt, std::string const& shown_path = {});
  /// The same for bytes at hand, which messages call `name`. rows_before: of the file, which the bytes leave out.
  static Table parse(std::string name, std::string bytes, std::optional<Span> mention = std::nullopt, int rows_before = 0);

  std::string const& name() const { return name_; }
  int rows() const { return rows_; }
  std::vector<std::string> const& columns() const { return columns_; }
  /// The line of the file, from 1, of row `row`, from 1.
  int line(int row) const { return header_line_ + rows_before_ + row; }
  int rows_before() const { return rows_before_; }
  /// SHA-256 of the file's bytes.
  std::string const& digest() const { return digest_; }
  /// The comment lines before the header, without their `#` and the blanks around.
  std::vector<std::string> const& comments() const { return comments_; }

  /// The numbers of one column, quiet NaN where the cell is empty or NA. Decimal point whatever the locale; a leading + and blanks
  /// around a number are allowed. UserError: no such column (naming those there are), more than one, or a cell that is neither a
  /// finite number nor missing.
  std::vector<double> numbers(std::string const& column, std::optional<Span> mention = std::nullopt) const;

 private:
  std::string_view cell(int row, int column) const;
  /// The first row holds words where the second holds numbers.
  bool names_units() const;
  /// Whether numbers stand below the names. Of another file, which a model of somebody else may name, no message quotes anything.
  bool is_record() const;

  std::string name_, bytes_, digest_;
  std::vector<std::string> columns_, comments_;
  std::vector<std::uint64_t>
      cells_;  // [rows x (columns + 1)]: where each cell begins; the last entry of a row: one past its end + 1
  int rows_ = 0, rows_before_ = 0;
  int header_line_ = 0;
};

}  // namespace sysid
