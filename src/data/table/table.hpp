// A text file as a table of named columns: strict, so that a wrong file is an error naming its row and column, never a wrong
// number.
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/text/source.hpp"
#include "data/cell/number_notation.hpp"
#include "data/table/column_needs.hpp"
#include "data/table/reading_rules.hpp"
#include "data/table/record_file.hpp"

namespace sysid {

struct SerialTime;

/// Without rules: comma, semicolon or tab separated, whichever divides the header most often; one header line with the names
/// (quoted or not), before it any number of empty lines and of comment lines that begin with `#`, and as the first line of all
/// `sep=;`. Line ends LF, CRLF or CR; UTF-8, or UTF-16 with its mark. ReadingRules change each of these. Cells are kept as text:
/// only columns that are asked for need to hold numbers. A message about a file that other rules would read has the statement with
/// them as its help.
class Table final : public RecordFile {
 public:
  /// Also of a gzip file. IoError when the file cannot be read, UserError (at `mention`) when it is no such table.
  static Table read(std::string const& path, std::optional<Span> mention = std::nullopt, ReadingRules const& rules = {});
  /// The same for bytes at hand, which messages call `name`. rows_before: of the file, which the bytes leave out.
  static Table parse(std::string name, std::string bytes, std::optional<Span> mention = std::nullopt, std::int64_t rows_before = 0,
                     ReadingRules const& rules = {}, ColumnNeeds const& needs = {});
  /// Without a look at what other rules would read: for who tries rules.
  static Table parse_as_told(std::string name, std::string bytes, ReadingRules const& rules);

  std::string const& name() const override { return name_; }
  int rows() const { return rows_; }
  std::optional<int> row_count() const override { return rows_; }
  std::vector<std::string> const& columns() const override { return columns_; }
  /// The line of the file, from 1, of row `row`, from 1.
  std::int64_t line(int row) const;
  std::int64_t rows_before() const { return rows_before_; }
  std::string const& digest() const override { return digest_; }
  void set_digest(std::string digest) { digest_ = std::move(digest); }
  /// The comment lines before the header, without their `#` and the blanks around.
  std::vector<std::string> const& comments() const override { return comments_; }
  ReadingRules const& rules() const { return rules_; }

  /// Quiet NaN where the cell is empty or NA, or as `missing` says. Decimal point whatever the locale; a leading + and blanks
  /// around a number are allowed. UserError: no such column (naming those there are), more than one, or a cell that is neither a
  /// finite number nor missing, or one that may be either of two numbers.
  std::vector<double> numbers(std::string const& column, std::optional<Span> mention = std::nullopt) const override;
  /// Seconds since the first row where `stamp` says so; time of day runs on past midnight.
  std::vector<double> times(std::string const& column, std::optional<Span> mention = std::nullopt) const override;
  bool has_stamps() const override { return !rules_.stamp.empty(); }
  std::optional<std::string> unit(std::string const& column) const override;
  data_errors::Cell place(std::size_t index, std::string const& column) const override;

  /// The texts of a column, without quotes; at most `most`.
  std::vector<std::string> texts(int column, int most) const;
  /// The file in UTF-8, for who looks for other rules.
  std::string const& bytes() const { return bytes_; }

 private:
  friend class TableParser;
  int index_of(std::string const& column, std::optional<Span> mention) const;
  std::vector<double> numbers_as_told(std::string const& column, std::optional<Span> mention) const;
  /// unit: of all cells; null where each has its own, `0.01 sec`.
  std::vector<double> serial_times_as_told(std::string const& column, SerialTime const* unit, std::optional<Span> mention) const;
  std::vector<double> times_as_told(std::string const& column, std::optional<Span> mention) const;
  /// The first row of a column whose points may stand between groups of digits: `1.234` beside `999`, and nothing that decides; or
  /// 0.
  int row_of_doubtful_points(int column) const;
  void refuse_doubtful_points(int column, std::optional<Span> mention) const;
  [[noreturn]] void rethrow_with_proposal(UserError const& error, std::string const& column) const;
  std::string_view cell(int row, int column) const;
  /// The first row holds words where the second holds numbers.
  bool names_units() const;
  /// Whether numbers stand below the names. Of another file, which a model of somebody else may name, no message quotes anything.
  bool is_record() const;

  std::string name_, bytes_, digest_;
  ReadingRules rules_;
  ColumnNeeds needs_;
  NumberNotation notation_;
  std::vector<std::string> columns_, comments_, units_;
  std::vector<std::uint64_t>
      cells_;               // [rows x (columns + 1)]: where each cell begins; the last entry of a row: one past its end + 1
  std::vector<int> lines_;  // [rows], where lines between them are left out; else empty
  int rows_ = 0;
  std::int64_t rows_before_ = 0;
  int header_line_ = 0;
  char separator_ = ',';
  bool proposes_ = true;  // messages look for other rules
};

}  // namespace sysid
