// A CSV of numbers as this program writes it, read back: comment lines, one header, cells that are shortest round-trip decimals.
// Used for draws, bands and records alike.
#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace sysid {

struct NumberTable {
  std::map<std::string, std::string> head;   // "experiment" of the comment `# experiment = bench`
  std::vector<std::string> names;            // of the header
  std::vector<std::vector<double>> columns;  // [names][rows]

  std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
  /// The first column of that name from the given one on, or nullptr.
  std::vector<double> const* find(std::string_view name, std::size_t from = 0) const;
};

/// UserError, naming the file and the line, where a row has more or fewer cells than the header or a cell is no number; IoError
/// where it cannot be read.
NumberTable read_number_table(std::filesystem::path const& path);
/// The same of the text of that file.
NumberTable parse_number_table(std::string_view text, std::filesystem::path const& path);

}  // namespace sysid
