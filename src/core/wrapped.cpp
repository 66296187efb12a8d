// Which lines are prose, and where they break.
#include "core/wrapped.hpp"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>

namespace sysid {
namespace {

/// Characters on the screen: neither the bytes that continue one in UTF-8 nor what switches a colour ("ESC[1m").
int width(std::string_view text) {
  int count = 0;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] == '\033') {
      i = std::min(text.find('m', i), text.size());
    } else if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) {
      ++count;
    }
  }
  return count;
}

/// Columns stand two spaces apart; sources have their margin, pictures are drawn with lines and dots (U+2500 to U+28FF).
bool has_columns(std::string_view text) {
  auto const begin = text.find_first_not_of(' ');
  if (begin == std::string_view::npos) return true;
  if (text.find("  ", begin) != std::string_view::npos || text.find(" | ") != std::string_view::npos) return true;
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
    int const wide = width(text.substr(0, space));
    if (wide > columns) return at_comma != std::string_view::npos ? at_comma : std::min(at_space, space);
    at_space = space;
    bool const comma = std::string_view(",;:").find(text[space - 1]) != std::string_view::npos;
    if (comma && wide > near) at_comma = space;
  }
  return width(text) <= columns ? std::string_view::npos : at_comma != std::string_view::npos ? at_comma : at_space;
}

}  // namespace

std::string wrapped(std::string_view line, int columns) {
  if (columns <= 0 || width(line) <= columns || has_columns(line)) return std::string(line);
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

int terminal_columns(int descriptor) {
  winsize size = {};
  if (isatty(descriptor) == 0) return 0;
  return ioctl(descriptor, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

WrappedOutput::WrappedOutput(std::ostream& sink, int descriptor) : std::ostream(nullptr), lines_(sink, descriptor) {
  rdbuf(&lines_);
}
WrappedOutput::~WrappedOutput() { lines_.end(); }

void WrappedOutput::Lines::put(char character) {
  if (character != '\n') {
    line_ += character;
    return;
  }
  // The window may have been resized since the line before.
  sink_ << (begun_ ? line_ : wrapped(line_, terminal_columns(descriptor_))) << '\n';
  line_.clear();
  begun_ = false;
}

void WrappedOutput::Lines::end() {
  begun_ = begun_ || !line_.empty();
  sink_ << line_ << std::flush;
  line_.clear();
}

WrappedOutput::Lines::int_type WrappedOutput::Lines::overflow(int_type character) {
  if (traits_type::eq_int_type(character, traits_type::eof())) return traits_type::not_eof(character);
  put(traits_type::to_char_type(character));
  return sink_ ? character : traits_type::eof();
}

std::streamsize WrappedOutput::Lines::xsputn(char const* text, std::streamsize count) {
  for (std::streamsize i = 0; i < count; ++i) put(text[i]);
  return sink_ ? count : 0;
}

int WrappedOutput::Lines::sync() {
  end();
  return sink_ ? 0 : -1;
}

}  // namespace sysid
