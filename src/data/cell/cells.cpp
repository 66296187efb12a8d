// A line is cut at its separators; what stands in quotes is one cell.
#include "data/cell/cells.hpp"

#include <algorithm>

namespace sysid {

bool Lines::next() {
  if (next_ >= bytes_.size()) return false;
  begin = next_;
  void const* const found = std::memchr(bytes_.data() + begin, end_character_, bytes_.size() - begin);
  end = found == nullptr ? bytes_.size() : static_cast<std::size_t>(static_cast<char const*>(found) - bytes_.data());
  next_ = end + 1;
  if (end > begin && bytes_[end - 1] == '\r') --end;
  ++number;
  return true;
}

bool is_quoted_cell(std::string_view trimmed_cell) {
  return trimmed_cell.size() >= 2 && trimmed_cell.front() == '"' && trimmed_cell.back() == '"';
}

std::string unquoted_cell(std::string_view cell) {
  cell = trimmed(cell, cell_blanks);
  if (!is_quoted_cell(cell)) return std::string(cell);
  std::string text;
  for (std::size_t i = 1; i + 1 < cell.size(); ++i) {
    text += cell[i];
    if (cell[i] == '"') ++i;
  }
  return std::string(trimmed(text, cell_blanks));
}

std::string with_plain_blanks(std::string_view text) {
  std::string plain(text);
  for (std::string_view const blank : wide_blanks)
    for (std::size_t at; (at = plain.find(blank)) != std::string::npos;) plain.replace(at, blank.size(), " ");
  return plain;
}

char find_separator(std::string_view header) {
  std::size_t counts[3] = {};
  constexpr std::string_view candidates = ",;\t";
  bool quoted = false;
  for (char const c : header) {
    if (c == '"') quoted = !quoted;
    std::size_t const which = candidates.find(c);
    if (!quoted && which != std::string_view::npos) ++counts[which];
  }
  return candidates[static_cast<std::size_t>(std::max_element(counts, counts + 3) - counts)];
}

std::optional<std::string_view> stated_separator(std::string_view line) {
  if (line.size() >= 2 && line.front() == '"' && line.back() == '"') line = line.substr(1, line.size() - 2);
  if (line.size() < 5 || !(line.starts_with("sep=") || line.starts_with("SEP=") || line.starts_with("Sep="))) return std::nullopt;
  return line.size() == 5 || trimmed(line, cell_blanks).size() == 5 ? std::optional(line.substr(4)) : std::nullopt;
}

}  // namespace sysid
