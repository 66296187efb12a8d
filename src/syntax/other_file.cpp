// By the bytes that a format begins with, or by the first two lines.
#include "syntax/other_file.hpp"

#include <algorithm>

#include "syntax/words.hpp"

namespace sysid {
namespace {

struct Signature {
  std::string_view begin, kind;
};

using namespace std::string_view_literals;
constexpr Signature signatures[] = {
    {"PK\x03\x04"sv, "a spreadsheet or another ZIP archive"},
    {"\x89HDF"sv, "a file of HDF5 or MATLAB (.mat)"},
    {"MATLAB 5.0"sv, "a file of MATLAB (.mat)"},
    {"\x1f\x8b"sv, "a gzip archive"},
    {"\xff\xfe"sv, "a text in UTF-16: save it in UTF-8"},
    {"\xfe\xff"sv, "a text in UTF-16: save it in UTF-8"},
    {"%PDF"sv, "a PDF document"},
    {"\x89PNG"sv, "a picture"},
    {"\x7f"
     "ELF"sv,
     "a program"},
    {"<"sv, "an HTML or XML document"},
    {"{"sv, "a JSON document"},
};

constexpr std::string_view separators = ",;\t";

/// The next line that is neither empty nor a comment.
std::string_view take_line(std::string_view& text) {
  while (!text.empty()) {
    auto const end = text.find('\n');
    std::string_view line = text.substr(0, end);
    text.remove_prefix(end == text.npos ? text.size() : end + 1);
    while (!line.empty() && (line.back() == '\r' || line.back() == ' ')) line.remove_suffix(1);
    if (!line.empty() && line.front() != '#') return line;
  }
  return {};
}

bool is_number(std::string_view cell) {
  return cell.find_first_not_of("+-.0123456789eE \"") == cell.npos && cell.find_first_of("0123456789") != cell.npos;
}

/// A line of numbers with separators between them, below a line with as many cells.
bool is_table(std::string_view text) {
  std::string_view const header = take_line(text), row = take_line(text);
  for (char const separator : separators) {
    auto const count = std::count(row.begin(), row.end(), separator);
    if (count == 0 || count != std::count(header.begin(), header.end(), separator)) continue;
    std::string_view rest = row;
    bool numbers = true;
    for (auto cells = count + 1; cells > 0 && numbers; --cells) {
      auto const end = rest.find(separator);
      std::string_view const cell = rest.substr(0, end);
      numbers = cell.empty() || is_number(cell);
      rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
    }
    if (numbers) return true;
  }
  return false;
}

/// More than a twentieth of it are bytes that no text has; one may have slipped in.
bool is_binary(std::string_view head) {
  auto const strange = std::count_if(head.begin(), head.end(), [](char c) {
    return (static_cast<unsigned char>(c) < ' ' && c != '\t' && c != '\n' && c != '\r' && c != '\f') || c == '\x7f';
  });
  return strange > 1 && 20 * strange > static_cast<std::ptrdiff_t>(head.size());
}

}  // namespace

bool ends_lines_by_return(std::string_view text) {
  return text.find('\n') == text.npos && std::count(text.begin(), text.end(), '\r') > 1;
}

std::string_view other_kind(std::string_view text) {
  if (ends_lines_by_return(text)) return "a text whose lines end in CR alone, as on old Macs: save it with LF";
  // What begins as a .sysid file is one, whatever follows.
  for (std::string_view const item : words::items)
    if (text.starts_with(item) && text.substr(item.size()).starts_with(' ')) return {};
  for (Signature const& each : signatures)
    if (text.starts_with(each.begin)) return each.kind;
  if (is_binary(text.substr(0, 4096))) return "a binary file";
  if (is_table(text)) return "a table of numbers (CSV)";
  return {};
}

}  // namespace sysid
