// Places in a text: byte offsets to lines and columns.
#include "core/source.hpp"

#include <algorithm>

namespace sysid {

Span cover(Span a, Span b) { return {std::min(a.begin, b.begin), std::max(a.end, b.end)}; }

Source::Source(std::string name, std::string text) : name_(std::move(name)), text_(std::move(text)), line_begins_{0} {
  for (std::size_t i = 0; i < text_.size(); ++i)
    if (text_[i] == '\n') line_begins_.push_back(static_cast<std::uint32_t>(i + 1));
}

std::string_view Source::text(Span span) const {
  std::size_t const begin = std::min<std::size_t>(span.begin, text_.size());
  std::size_t const end = std::clamp<std::size_t>(span.end, begin, text_.size());
  return std::string_view(text_).substr(begin, end - begin);
}

Place Source::place(std::uint32_t offset) const {
  offset = std::min(offset, static_cast<std::uint32_t>(text_.size()));
  auto const after = std::upper_bound(line_begins_.begin(), line_begins_.end(), offset);
  Place place{static_cast<int>(after - line_begins_.begin()), 1};
  // Bytes 10xxxxxx continue a character.
  for (std::uint32_t i = *(after - 1); i < offset; ++i)
    if ((static_cast<unsigned char>(text_[i]) & 0xC0U) != 0x80U) ++place.column;
  return place;
}

std::uint32_t Source::line_begin(int number) const {
  if (number < 1 || static_cast<std::size_t>(number) > line_begins_.size()) return static_cast<std::uint32_t>(text_.size());
  return line_begins_[static_cast<std::size_t>(number) - 1];
}

std::string_view Source::line(int number) const {
  std::uint32_t const begin = line_begin(number);
  std::string_view const rest = std::string_view(text_).substr(begin);
  std::string_view line = rest.substr(0, rest.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

}  // namespace sysid
