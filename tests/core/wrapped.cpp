// Prose goes on below, between words; what has columns stays whole.
#include "core/wrapped.hpp"

#include <doctest/doctest.h>

#include <sstream>

using namespace sysid;

TEST_CASE("a line of prose goes on four further in, between words") {
  CHECK(wrapped("  note[x]: one two three", 14) == "  note[x]: one\n      two\n      three");
  CHECK(wrapped("one two", 7) == "one two");
  CHECK(wrapped("a_word_that_is_too_long for this", 10) == "a_word_that_is_too_long\n    for\n    this");
  CHECK(wrapped("ä ö ü", 5) == "ä ö ü");
  CHECK(wrapped("\033[1;31merror\033[0m: no", 9) == "\033[1;31merror\033[0m: no");
  CHECK(wrapped("", 5).empty());
}

TEST_CASE("without a width, and where columns have a meaning, nothing moves") {
  for (std::string const line : {"k      N/mm    32.663    0.38", "  3 | parameter k [N/mm] ~ normal(0, 1)",
                                 "    | ^^^^^^^^^  here", "    0 │▁▁▁▁▁▁▄▄▄ and more words", "⠄ ⢀⠂ and more words", "            "})
    CHECK(wrapped(line, 10) == line);
  CHECK(wrapped("one two three", 0) == "one two three");
}

TEST_CASE("what is no terminal gets what was written, at each flush and at the end") {
  std::ostringstream sink;
  {
    WrappedOutput out(sink, -1);
    out << "one " << 2 << '\n' << "half a" << std::flush;
    CHECK(sink.str() == "one 2\nhalf a");
    out << " line\nno end";
  }
  CHECK(sink.str() == "one 2\nhalf a line\nno end");
}

TEST_CASE("a comma near the end is the better place") {
  CHECK(wrapped("output: nmse 3.27 [%], rmse 0.011 [V], whiteness_p 0", 50) ==
        "output: nmse 3.27 [%], rmse 0.011 [V],\n    whiteness_p 0");
  CHECK(wrapped("at once, and then words that go on without a stop for long", 50) ==
        "at once, and then words that go on without a stop\n    for long");
}
