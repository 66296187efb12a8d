// Characters of UTF-8 against bytes.
#include "core/text/utf8.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("a text is as wide as it has characters, not bytes") {
  CHECK(text_width("") == 0);
  CHECK(text_width("m/s²") == 4);
  CHECK(text_width("äöü𝜃") == 4);
  CHECK_FALSE(continues_character("é"[0]));
  CHECK(continues_character("é"[1]));
}

TEST_CASE("no character is cut in two") {
  CHECK(character_begin("aéb", 0) == 0);
  CHECK(character_begin("aéb", 1) == 1);
  CHECK(character_begin("aéb", 2) == 1);
  CHECK(character_begin("aéb", 3) == 3);
  CHECK(character_begin("aéb", 9) == 4);
  CHECK(character_begin("\x80\x80", 1) == 0);  // malformed: nothing begins a character
  CHECK(first_characters("aéb", 2) == "aé");
  CHECK(first_characters("aéb", 0) == "");
  CHECK(first_characters("aéb", 3) == "aéb");
  CHECK(first_characters("aéb", 7) == "aéb");
}
