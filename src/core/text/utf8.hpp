// Characters of UTF-8 within a string of bytes.
#pragma once
#include <cstddef>
#include <string_view>

namespace sysid {

/// Whether a byte continues a character (10xxxxxx) instead of beginning one.
constexpr bool continues_character(char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; }

/// Number of characters: the columns that a text takes on the screen.
int text_width(std::string_view text);

/// The beginning of the character that holds byte `at`; the size of the text for a place beyond its end.
std::size_t character_begin(std::string_view text, std::size_t at);

/// The first `count` characters; the whole text where it has fewer.
std::string_view first_characters(std::string_view text, int count);

}  // namespace sysid
