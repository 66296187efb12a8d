// A file with a record, of any format: named columns of numbers. Each format has a class; data/format says which is whose.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/text/source.hpp"
#include "data/table/error_parts.hpp"

namespace sysid {

class RecordFile {
 public:
  RecordFile() = default;
  virtual ~RecordFile() = default;

  /// As messages call it.
  virtual std::string const& name() const = 0;
  /// SHA-256 of the file's bytes.
  virtual std::string const& digest() const = 0;
  /// Where all columns have the same number of rows.
  virtual std::optional<int> row_count() const { return std::nullopt; }
  /// The columns of numbers that may be asked for, as the file names them.
  virtual std::vector<std::string> const& columns() const = 0;
  /// The numbers of a column, quiet NaN where one is missing. UserError at `mention` where there is no such column, or one that is
  /// none of finite numbers.
  virtual std::vector<double> numbers(std::string const& column, std::optional<Span> mention = std::nullopt) const = 0;
  /// The same of the column with the time: dates and times of day as seconds since the first row.
  virtual std::vector<double> times(std::string const& column, std::optional<Span> mention = std::nullopt) const {
    return numbers(column, mention);
  }
  /// Whether `times` are seconds because the column holds dates or times of day.
  virtual bool has_stamps() const { return false; }
  /// The unit of a column as the file states it, where it does and is asked to.
  virtual std::optional<std::string> unit(std::string const& column) const {
    (void)column;
    return std::nullopt;
  }
  /// What else the file has, and why it is no column of numbers: "is text".
  virtual std::vector<std::pair<std::string, std::string>> left_out() const { return {}; }
  /// What the author of the file says of it all.
  virtual std::vector<std::string> const& comments() const = 0;
  /// The place of a number, for messages; index from 0.
  virtual data_errors::Cell place(std::size_t index, std::string const& column) const {
    return {name(), static_cast<int>(index) + 1, 0, column};
  }

 protected:
  RecordFile(RecordFile const&) = default;
  RecordFile(RecordFile&&) = default;
  RecordFile& operator=(RecordFile const&) = default;
  RecordFile& operator=(RecordFile&&) = default;
};

}  // namespace sysid
