// A byte that begins a character of four bytes stands for two code units, any other that begins one for one.
#include "lsp/positions.hpp"

#include <algorithm>

#include "core/text/utf8.hpp"

namespace sysid::lsp {
namespace {

int units(char byte) { return continues_character(byte) ? 0 : static_cast<unsigned char>(byte) >= 0xF0U ? 2 : 1; }

}  // namespace

Lines::Lines(std::string_view text) : text_(text), begins_{0} {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '\n' || (text[i] == '\r' && (i + 1 == text.size() || text[i + 1] != '\n')))
      begins_.push_back(static_cast<std::uint32_t>(i + 1));
}

Position Lines::position(std::uint32_t offset) const {
  offset = std::min(offset, static_cast<std::uint32_t>(text_.size()));
  offset = static_cast<std::uint32_t>(character_begin(text_, offset));
  auto const behind = std::upper_bound(begins_.begin(), begins_.end(), offset);
  Position position{static_cast<int>(behind - begins_.begin()) - 1, 0};
  for (std::uint32_t i = *(behind - 1); i < offset; ++i) position.character += units(text_[i]);
  return position;
}

std::uint32_t Lines::offset(Position position) const {
  if (position.line < 0) return 0;
  if (static_cast<std::size_t>(position.line) >= begins_.size()) return static_cast<std::uint32_t>(text_.size());
  std::uint32_t at = begins_[static_cast<std::size_t>(position.line)];
  int left = position.character;
  while (at < text_.size() && text_[at] != '\n' && text_[at] != '\r') {
    if (units(text_[at]) > left) break;
    left -= units(text_[at]);
    ++at;
    while (at < text_.size() && continues_character(text_[at])) ++at;
    if (left <= 0) break;
  }
  return at;
}

}  // namespace sysid::lsp
