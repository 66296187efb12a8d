// Every byte that does not continue a character begins one: malformed text is counted, never refused.
#include "core/text/utf8.hpp"

#include <algorithm>

namespace sysid {

int text_width(std::string_view text) {
  return static_cast<int>(std::count_if(text.begin(), text.end(), [](char byte) { return !continues_character(byte); }));
}

std::size_t character_begin(std::string_view text, std::size_t at) {
  while (at > 0 && at < text.size() && continues_character(text[at])) --at;
  return std::min(at, text.size());
}

std::string_view first_characters(std::string_view text, int count) {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (!continues_character(text[i]) && --count < 0) return text.substr(0, i);
  return text;
}

}  // namespace sysid
