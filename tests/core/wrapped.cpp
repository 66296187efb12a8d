// Prose goes on below, between words; what has columns stays whole.
#include "core/text/wrapped.hpp"

#include <doctest/doctest.h>

#include <sstream>

#include "core/text/diagnostic.hpp"

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
    LineOutput out(sink, wrapped_for(-1));
    out << "one " << 2 << '\n' << "half a" << std::flush;
    CHECK(sink.str() == "one 2\nhalf a");
    out << " line\nno end";
  }
  CHECK(sink.str() == "one 2\nhalf a line\nno end");
  std::string const page = "prose that is\nlong enough\n\nname  what it is and does\nno end";
  CHECK(wrapped(page, 0) == page);
  CHECK(filled(page, 0) == page);
  CHECK(wrapped_rows(page, 0) == page);
}

TEST_CASE("lines are wrapped as they come, in the width that there is then") {
  int columns = 8;
  std::ostringstream sink;
  LineOutput out(sink, [&](std::string const& line) { return wrapped(line, columns); });
  out << "one two three\n";
  CHECK(sink.str() == "one two\n    three\n");
  columns = 80;
  out << "one two three\n";
  CHECK(sink.str().ends_with("three\none two three\n"));
}

TEST_CASE("the source lines of a message stay whole, coloured or not; its prose is wrapped") {
  Source const source("long.sysid", "parameter stiffness [N/m] ~ log_uniform(1, 1e6) # a comment with many words in it\n");
  Diagnostic const diagnostic{Severity::error,         "E2001", "some words about what is wrong with this line of the file",
                              Label{{10, 19}, "here"}, {},      "and some more words about what is to be done about it"};
  for (bool const colour : {false, true}) {
    CAPTURE(colour);
    std::string const text = render(diagnostic, source, colour), shown = wrapped(text, 40);
    CHECK(shown.find("log_uniform(1, 1e6) # a comment with many words in it\n") != std::string::npos);
    CHECK(shown.find("]: some words about what is wrong") == std::string::npos);
    CHECK(shown.find("\n    to be done") != std::string::npos);
  }
}

TEST_CASE("paragraphs and list items of a page are filled anew; what has a layout of its own stays") {
  std::string const laid_out =
      "# a heading that is longer than the page is wide\n\n| a | table | of | Markdown |\n\n"
      "    an indented example that is long enough\n\n```sysid file\nz' = A*y' - alpha*abs(y')*z - beta*y'*abs(z)\n```\n";
  CHECK(filled(laid_out, 20) == laid_out);
  CHECK(filled("a line, full to the edge,\nand a stub\nof it\n\nthe next\n", 18) ==
        "a line, full to\nthe edge, and a\nstub of it\n\nthe next\n");
  CHECK(filled("short\nlines\n", 80) == "short lines\n");
  CHECK(filled("- an item of many words\n  that goes on\n- the next\n12. a number\nprose\n", 14) ==
        "- an item of\n  many words\n  that goes on\n- the next\n12. a number\nprose\n");
  CHECK(filled("Bad:\n    let k = 1\nCorrected:\n", 80) == "Bad:\n    let k = 1\nCorrected:\n");
}

TEST_CASE("the sentence of a row goes on below itself, or below its row where it has too little room") {
  CHECK(wrapped_rows("  sin     the sine of an angle in radians, as ever\n  cos     the cosine\n", 36) ==
        "  sin     the sine of an angle in\n          radians, as ever\n  cos     the cosine\n");
  // A name as wide as its column.
  CHECK(wrapped_rows("sin  the sine\nsine the same sine of an angle, again\n", 30) ==
        "sin  the sine\nsine the same sine of an\n     angle, again\n");
  CHECK(wrapped_rows("a_signature(with, arguments)  what it is, in words\n", 40) ==
        "a_signature(with, arguments)\n    what it is, in words\n");
  CHECK(wrapped_rows("mh: some words of a heading\n  samples  1  of a chain\n", 20) ==
        "mh: some words of a\n    heading\n  samples  1\n      of a chain\n");
}

TEST_CASE("a comma near the end is the better place") {
  CHECK(wrapped("output: nmse 3.27 [%], rmse 0.011 [V], whiteness_p 0", 50) ==
        "output: nmse 3.27 [%], rmse 0.011 [V],\n    whiteness_p 0");
  CHECK(wrapped("at once, and then words that go on without a stop for long", 50) ==
        "at once, and then words that go on without a stop\n    for long");
}
