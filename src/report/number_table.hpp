// A CSV of numbers as this program writes it, read back: comment lines, one header, cells that are shortest round-trip decimals.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace sysid {

struct NumberTable {
  std::vector<std::string> names;            // of the header
  std::vector<std::vector<double>> columns;  // [names][rows]

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// UserError, naming the file and the line, where a row has more or fewer cells than the header or a cell is no number; IoError
/// where it cannot be read.
NumberTable read_number_table(std::filesystem::path const& path);

}  // namespace sysid
