// Files of other kinds, by their first bytes or lines.
#include "syntax/other_file.hpp"

#include <doctest/doctest.h>

#include <string>

using namespace sysid;
using namespace std::string_literals;

TEST_CASE("records, archives and documents are known, texts of the language and slips in them are not") {
  CHECK(other_kind("t,y\n0,1\n") == "a table of numbers (CSV)");
  CHECK(other_kind("# made\n\n\"t [s]\";y\r\n0;1.5e-3\r\n") == "a table of numbers (CSV)");
  CHECK(other_kind("t\ty\n0\t\n") == "a table of numbers (CSV)");
  CHECK(other_kind("PK\x03\x04"s + "rest") == "a spreadsheet or another ZIP archive");
  CHECK(other_kind("MATLAB 5.0 MAT-file") == "a file of MATLAB (.mat)");
  CHECK(other_kind("{\"task\": 1}") == "a JSON document");
  CHECK(other_kind(std::string(100, '\0')) == "a binary file");
  for (char const* text : {"", "\n", "modle line {\n}\n", "parameter k, m\n1, 2, 3\n", "t,y\nzero,one\n", "rows 1..500, 2\n3, x\n"})
    CHECK(other_kind(text) == "");
  // A comment would hold the rest, which nothing would miss.
  CHECK(other_kind("# note\rmodel m {\r}\r").starts_with("a text whose lines end in CR alone"));
  for (char const* text : {"model m { }\r", "# note\r\nmodel m {\r\n}\r\n", "# a\rb\rc\nmodel m { }\n"})
    CHECK(other_kind(text) == "");
  CHECK(other_kind("model m {\0}\n"s) == "");  // one byte that slipped in
  CHECK(other_kind("model m \"" + std::string(100, '\1')) == "");
}
