// Places in a text: byte offsets to lines and columns.
#include "core/text/source.hpp"

#include <algorithm>
#include <cctype>

#include "core/text/utf8.hpp"

namespace sysid {

Span cover(Span a, Span b) { return {std::min(a.begin, b.begin), std::max(a.end, b.end)}; }

Source::Source(std::string name, std::string text) { include(std::move(name), std::move(text)); }

void Source::include(std::string name, std::string text) {
  if (!files_.empty()) text_ += '\n';
  auto const begin = static_cast<std::uint32_t>(text_.size());
  files_.push_back({std::move(name), begin, begin + static_cast<std::uint32_t>(text.size()), line_begins_.size()});
  line_begins_.push_back(begin);
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n') line_begins_.push_back(begin + static_cast<std::uint32_t>(i + 1));
  text_ += text;
}

std::string_view Source::text(int file) const {
  File const& it = files_[static_cast<std::size_t>(file)];
  return std::string_view(text_).substr(it.begin, it.end - it.begin);
}

std::string_view Source::text(Span span) const {
  std::size_t const begin = std::min<std::size_t>(span.begin, text_.size());
  std::size_t const end = std::clamp<std::size_t>(span.end, begin, text_.size());
  return std::string_view(text_).substr(begin, end - begin);
}

Place Source::place(std::uint32_t offset) const {
  offset = std::min(offset, static_cast<std::uint32_t>(text_.size()));
  auto const file = std::find_if(files_.rbegin(), files_.rend(), [&](File const& each) { return each.begin <= offset; });
  auto const after = std::upper_bound(line_begins_.begin(), line_begins_.end(), offset);
  Place place{static_cast<int>(after - line_begins_.begin()) - static_cast<int>(file->first_line), 1,
              static_cast<int>(files_.rend() - file) - 1};
  std::uint32_t const begin = *(after - 1);
  place.column += text_width(std::string_view(text_).substr(begin, offset - begin));
  return place;
}

std::uint32_t Source::line_begin(int number, int file) const {
  File const& it = files_[static_cast<std::size_t>(file)];
  if (number < 1 || it.first_line + static_cast<std::size_t>(number) > line_begins_.size()) return it.end;
  return std::min(line_begins_[it.first_line + static_cast<std::size_t>(number) - 1], it.end);
}

std::string_view Source::line(int number, int file) const {
  std::uint32_t const begin = line_begin(number, file);
  std::string_view const rest = text({begin, files_[static_cast<std::size_t>(file)].end});
  std::string_view line = rest.substr(0, rest.find('\n'));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

bool mentions(std::string_view text, std::string_view name) {
  auto const belongs = [&](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  for (std::size_t at = text.find(name); at != std::string_view::npos; at = text.find(name, at + 1))
    if (!(at > 0 && belongs(at - 1)) && !belongs(at + name.size())) return true;
  return false;
}

bool mentions(Source const& source, std::string_view name) { return mentions(source.text(), name); }

}  // namespace sysid
