// Lists, plurals and quotes in sentences.
#include "core/text/words.hpp"

#include <doctest/doctest.h>

#include "core/text/told_apart.hpp"

using namespace sysid;

TEST_CASE("names are listed with a word before the last") {
  CHECK(listed({}).empty());
  CHECK(listed({"m"}) == "m");
  CHECK(listed({"m", "c"}) == "m and c");
  CHECK(listed({"m", "c", "k"}) == "m, c and k");
  CHECK(listed({"m", "c", "k"}, "or") == "m, c or k");
  CHECK(quoted({}).empty());
  CHECK(quoted({"m", "c", "k"}) == "`m`, `c` and `k`");
  CHECK(quoted({"m", "c"}, "or") == "`m` or `c`");
}

TEST_CASE("of equal names the first stays, and no other becomes like one that was there") {
  using Names = std::vector<std::string>;
  CHECK(told_apart({}).empty());
  CHECK(told_apart({"b", "a"}) == Names{"b", "a"});
  CHECK(told_apart({"a", "a", "a_", "a", "b"}) == Names{"a", "a__", "a_", "a___", "b"});
  CHECK(told_apart({"", ""}) == Names{"", "_"});
}

TEST_CASE("of many names the first are listed, and how many follow") {
  CHECK(first_listed({}, 2).empty());
  CHECK(first_listed({"m", "c"}, 2) == "m, c");
  CHECK(first_listed({"m", "c", "k", "d"}, 2) == "m, c and 2 more");
}

TEST_CASE("one thing is singular, none and many are plural") {
  CHECK(counted(0, "row") == "0 rows");
  CHECK(counted(1, "row") == "1 row");
  CHECK(counted(std::size_t{2}, "row") == "2 rows");
  CHECK(plural("input", 1) == "input");
  CHECK(plural("input", 2) == "inputs");
}

TEST_CASE("blanks at both ends go, those inside stay") {
  CHECK(trimmed("") == "");
  CHECK(trimmed(" \t\r\n") == "");
  CHECK(trimmed(" a b\n") == "a b");
  CHECK(trimmed(" a\n", " ") == "a\n");
}

TEST_CASE("small letters are those of ASCII") {
  CHECK(in_small_letters("Kraft [N] ÄÖ 3") == "kraft [n] ÄÖ 3");
  CHECK(in_small_letters('Z') == 'z');
  CHECK(in_small_letters('[') == '[');
}
