// Finds where every cell of a table begins, in one pass.
#pragma once
#include <optional>
#include <string>

#include "data/table/table.hpp"

namespace sysid {

class TableParser {
 public:
  /// table: with its name, its bytes in UTF-8 and its rules; the rest is filled in.
  TableParser(Table& table, std::optional<Span> mention) : table_(table), mention_(mention) {}
  void run();

 private:
  class Rows;

  void find_names();
  void take_names(std::size_t begin, std::size_t end, int line);
  void name_columns(int line);
  void take_units(std::size_t begin, std::size_t end, int line);
  bool is_comment(std::string_view trimmed_line) const;

  Table& table_;
  std::optional<Span> mention_;
  char separator_ = ',';
  int names_line_ = 0;  // 0: no line has the names
  int first_value_ = 1;
};

}  // namespace sysid
