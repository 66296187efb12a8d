// Which lines are prose, and where they break.
#include "core/text/wrapped.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

#include "core/text/utf8.hpp"

namespace sysid {
namespace {

std::string without_colour(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\033')
      i = std::min(text.find('m', i), text.size());
    else
      plain += text[i];
  }
  return plain;
}

/// Characters on the screen: neither the bytes that continue one in UTF-8 nor what switches a colour ("ESC[1m").
int shown_width(std::string_view text) { return text_width(without_colour(text)); }

/// Columns stand two spaces apart; sources have their margin, pictures are drawn with lines and dots (U+2500 to U+28FF).
bool has_columns(std::string_view line) {
  std::string const text = without_colour(line);
  auto const begin = text.find_first_not_of(' ');
  if (begin == std::string::npos) return true;
  if (text.find("  ", begin) != std::string::npos || text.find(" | ") != std::string::npos || text.ends_with(" |")) return true;
  for (std::size_t i = 0; i + 1 < text.size(); ++i)
    if (text[i] == '\xe2' && text[i + 1] >= '\x94' && text[i + 1] <= '\xa3') return true;
  return false;
}

/// Where a line of at most `columns` ends in `text`: behind a comma where one is near, else at the last space; at the next space
/// where a word is too long. text: not to be looked at before `begin`, where its words begin.
std::size_t break_of(std::string_view text, std::size_t begin, int columns) {
  int const near = columns - columns * 3 / 10;
  std::size_t at_space = std::string_view::npos, at_comma = std::string_view::npos;
  for (std::size_t space = text.find(' ', begin); space != std::string_view::npos; space = text.find(' ', space + 1)) {
    int const wide = shown_width(text.substr(0, space));
    if (wide > columns) return at_comma != std::string_view::npos ? at_comma : std::min(at_space, space);
    at_space = space;
    bool const comma = std::string_view(",;:").find(text[space - 1]) != std::string_view::npos;
    if (comma && wide > near) at_comma = space;
  }
  return shown_width(text) <= columns ? std::string_view::npos : at_comma != std::string_view::npos ? at_comma : at_space;
}

std::string wrapped_line(std::string_view line, int columns) {
  if (shown_width(line) <= columns || has_columns(line)) return std::string(line);
  std::size_t begin = line.find_first_not_of(' ');
  std::string const further(begin + 4, ' ');
  std::string out, rest(line);
  for (std::size_t end; (end = break_of(rest, begin, columns)) != std::string_view::npos;) {
    out += rest.substr(0, end) + '\n';
    rest = further + rest.substr(end + 1);
    begin = further.size();
  }
  return out + rest;
}

/// `text` behind `first`, in lines of at most `columns`; all but the first are `indent` in.
std::string filled_behind(std::string first, std::string_view text, std::size_t indent, int columns) {
  std::string out, line = std::move(first);
  bool begun = false;  // a word stands in the line
  while (!text.empty()) {
    std::size_t const end = std::min(text.find(' '), text.size());
    std::string_view const word = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (begun && shown_width(line) + 1 + shown_width(word) > columns) {
      out += line + '\n';
      line.assign(indent, ' ');
      begun = false;
    }
    line += (begun ? " " : "") + std::string(word);
    begun = true;
  }
  return out + line;
}

/// Where the text of a list item begins, "- " and "12. "; 0 for other lines.
std::size_t item_text(std::string_view line) {
  std::size_t const begin = std::min(line.find_first_not_of(' '), line.size());
  if (line.substr(begin).starts_with("- ") || line.substr(begin).starts_with("* ")) return begin + 2;
  std::size_t const digits = std::min(line.find_first_not_of("0123456789", begin), line.size());
  return digits > begin && line.substr(digits).starts_with(". ") ? digits + 2 : 0;
}

std::string by_line(std::string_view text, int columns, std::function<std::string(std::string_view)> const& of_line) {
  if (columns <= 0) return std::string(text);
  std::string out;
  while (!text.empty()) {
    std::size_t const end = text.find('\n');
    out += of_line(text.substr(0, end));
    if (end == std::string_view::npos) break;
    out += '\n';
    text.remove_prefix(end + 1);
  }
  return out;
}

}  // namespace

std::string wrapped(std::string_view text, int columns) {
  return by_line(text, columns, [&](std::string_view line) { return wrapped_line(line, columns); });
}

std::string filled(std::string_view page, int columns) {
  if (columns <= 0) return std::string(page);
  std::string out, block;  // a paragraph or list item so far
  std::size_t indent = 0;
  bool fenced = false;
  auto const end_block = [&] {
    if (!block.empty())
      out += filled_behind(block.substr(0, indent), std::string_view(block).substr(indent), indent, columns) + '\n';
    block.clear();
  };
  while (!page.empty()) {
    std::size_t const end = std::min(page.find('\n'), page.size());
    std::string_view const line = page.substr(0, end);
    page.remove_prefix(std::min(end + 1, page.size()));
    bool const fence = line.starts_with("```");
    std::size_t const item = item_text(line);
    bool const plain = !fenced && !fence && !line.empty() && line.front() != '#' && line.front() != '|' && item == 0;
    bool const goes_on = plain && !block.empty() && line.find_first_not_of(' ') == indent;
    if (goes_on) {
      block += ' ';
      block += line.substr(indent);
      continue;
    }
    end_block();
    fenced = fenced != fence;
    indent = fenced || fence ? 0 : item;
    if ((plain && line.front() != ' ') || indent > 0)
      block = line;
    else
      out.append(line) += '\n';
  }
  end_block();
  return out;
}

std::string wrapped_rows(std::string_view rows, int columns) {
  constexpr int least = 24;          // columns for prose beside others
  std::size_t column = 0, left = 0;  // of the row before: where its prose begins, and its first word
  return by_line(rows, columns, [&](std::string_view line) -> std::string {
    std::size_t const begin = std::min(line.find_first_not_of(' '), line.size());
    std::size_t const gap = line.rfind("  ");
    // A cell as wide as its column leaves one space.
    bool const same = left == begin && column > 0 && column < line.size() && line[column - 1] == ' ' && line[column] != ' ';
    left = begin;
    if (gap != std::string_view::npos && gap > begin)
      column = gap + 2;
    else if (!same)
      column = 0;
    if (shown_width(line) <= columns) return std::string(line);
    if (column == 0) return filled_behind(std::string(begin, ' '), line.substr(begin), begin + 4, columns);
    std::string const others(line.substr(0, column));
    std::string_view const prose = line.substr(column);
    auto const wide = static_cast<std::size_t>(shown_width(others));
    if (static_cast<int>(wide) + least <= columns) return filled_behind(others, prose, wide, columns);
    return others.substr(0, others.find_last_not_of(' ') + 1) + '\n' +
           filled_behind(std::string(begin + 4, ' '), prose, begin + 4, columns);
  });
}

int terminal_columns(int descriptor) {
  winsize size = {};
  if (isatty(descriptor) == 0) return 0;
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

LineOutput::OfLine wrapped_for(int descriptor) {
  return [descriptor](std::string const& line) { return wrapped(line, terminal_columns(descriptor)); };
}

LineOutput::LineOutput(std::ostream& sink, OfLine of_line) : std::ostream(nullptr), lines_(sink, std::move(of_line)) {
  rdbuf(&lines_);
}
LineOutput::~LineOutput() { lines_.end(); }

void LineOutput::Lines::put(char character) {
  if (character != '\n') {
    line_ += character;
    return;
  }
  sink_ << (begun_ ? line_ : of_line_(line_)) << '\n';
  line_.clear();
  begun_ = false;
}

void LineOutput::Lines::end() {
  begun_ = begun_ || !line_.empty();
  sink_ << line_ << std::flush;
  line_.clear();
}

LineOutput::Lines::int_type LineOutput::Lines::overflow(int_type character) {
  if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(character);
  put(traits_type::to_char_type(character));
  return sink_ ? character : traits_type::eof();
}

std::streamsize LineOutput::Lines::xsputn(char const* text, std::streamsize count) {
  for (std::streamsize i = 0; i < count; ++i) put(text[i]);
  return sink_ ? count : 0;
}

int LineOutput::Lines::sync() {
  end();
  return sink_ ? 0 : -1;
}

}  // namespace sysid
