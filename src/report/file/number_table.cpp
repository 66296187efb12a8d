// Lines, cells, numbers; from_chars is the inverse of the writer.
#include "report/file/number_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/system/files.hpp"
#include "core/text/diagnostic.hpp"
#include "report/file/stored_files.hpp"

namespace sysid {

namespace {

/// The next cell of `line`, which loses it; a name in quotes may hold the separator.
std::string take_cell(std::string_view& line) {
  std::string cell;
  bool quoted = false;
  std::size_t at = 0;
  for (; at < line.size() && (quoted || line[at] != ','); ++at) {
    if (line[at] != '"') {
      cell += line[at];
    } else if (quoted && at + 1 < line.size() && line[at + 1] == '"') {
      cell += '"';
      ++at;
    } else {
      quoted = !quoted;
    }
  }
  line.remove_prefix(std::min(at + 1, line.size()));
  return cell;
}

UserError damaged(std::filesystem::path const& path, std::string const& what) {
  return unusable_result(fmt::format("`{}` is damaged: {}", path.string(), what));
}

}  // namespace

std::vector<double> const* NumberTable::find(std::string_view name, std::size_t from) const {
  auto const place = std::find(names.begin() + static_cast<std::ptrdiff_t>(std::min(from, names.size())), names.end(), name);
  return place == names.end() ? nullptr : &columns[static_cast<std::size_t>(place - names.begin())];
}

NumberTable read_number_table(std::filesystem::path const& path) { return parse_number_table(read_regular_file(path), path); }

NumberTable parse_number_table(std::string_view text, std::filesystem::path const& path) {
  std::string_view rest = text;
  NumberTable table;
  for (int number = 1; !rest.empty(); ++number) {
    std::size_t const end = rest.find('\n');
    if (end == rest.npos) throw damaged(path, fmt::format("line {} is truncated", number));
    std::string_view line = rest.substr(0, end);
    rest.remove_prefix(end + 1);
    if (line.starts_with("# "))
      if (std::size_t const equals = line.find(" = "); equals != line.npos)
        table.head.emplace(line.substr(2, equals - 2), line.substr(equals + 3));
    if (line.empty() || line.front() == '#') continue;
    if (table.names.empty()) {
      while (!line.empty()) table.names.push_back(take_cell(line));
      table.columns.resize(table.names.size());
      continue;
    }
    char const* at = line.data();
    char const* const last = at + line.size();
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      double value = 0;
      auto const [next, error] = std::from_chars(at, last, value);
      bool const ends = c + 1 == table.columns.size();
      if (error != std::errc() || (ends ? next != last : next == last || *next != ','))
        throw damaged(path, fmt::format("line {} does not hold {} numbers", number, table.columns.size()));
      table.columns[c].push_back(value);
      at = next + 1;
    }
  }
  if (table.names.empty()) throw damaged(path, "it has no header");
  if (auto const format = table.head.find("format"); format == table.head.end() || format->second != std::to_string(stored_form))
    throw unusable_result(fmt::format("`{}` was written by another version of sysid", path.string()));
  return table;
}

}  // namespace sysid
