// Places in a text: lines, columns in UTF-8 characters, line ends of every system.
#include "core/text/source.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("an offset has the line and column of its byte, both from one") {
  Source const source("a.sysid", "one\ntwo\n\nfour");
  CHECK(source.place(0).line == 1);
  CHECK(source.place(0).column == 1);
  CHECK(source.place(5).line == 2);
  CHECK(source.place(5).column == 2);
  CHECK(source.place(8).line == 3);
  CHECK(source.place(9).line == 4);
}

TEST_CASE("a newline belongs to the line it ends") {
  Source const source("a", "one\ntwo");
  CHECK(source.place(3).line == 1);
  CHECK(source.place(3).column == 4);
}

TEST_CASE("a column counts characters, not bytes") {
  Source const source("a", "\xC3\xB6\xCF\x83 = k");  // two letters of two bytes each
  CHECK(source.place(5).column == 4);
  CHECK(source.place(7).column == 6);
}

TEST_CASE("an offset beyond the text is at its end") {
  Source const source("a", "ab\ncd");
  CHECK(source.place(99).line == 2);
  CHECK(source.place(99).column == 3);
}

TEST_CASE("a line comes without its end, carriage return included") {
  Source const source("a", "one\r\ntwo\n");
  CHECK(source.line(1) == "one");
  CHECK(source.line(2) == "two");
  CHECK(source.line(3).empty());
  CHECK(source.line(4).empty());
  CHECK(source.line(0).empty());
}

TEST_CASE("the text of a span is cut at the end of the source") {
  Source const source("a", "abcdef");
  CHECK(source.text({2, 4}) == "cd");
  CHECK(source.text({4, 99}) == "ef");
  CHECK(source.text({99, 100}).empty());
}

TEST_CASE("cover spans both") {
  CHECK(cover({4, 6}, {1, 5}) == Span{1, 6});
  CHECK(cover({1, 9}, {2, 3}) == Span{1, 9});
}
