// Parts of a record: which may share rows.
#include "checking.hpp"

using namespace sysid;

namespace {

std::string with_split(std::string const& parts) {
  return test::messages("data d {\nfile \"d.csv\"\nrate 10 [Hz]\nmeasure y = y\nsplit " + parts + "\n}\n");
}

}  // namespace

TEST_CASE("parts that share rows at their ends are refused, with the rows") {
  std::string const one = with_split("train = rows 1..4, test = rows 4..8");
  CHECK(one.find("error[E4116]: row 4 is in both ranges `train` and `test`") != std::string::npos);
  CHECK(one.find("begin `test` at row 5") != std::string::npos);
  CHECK(with_split("train = rows 1..4, test = rows 5..8") == "");
  CHECK(with_split("test = rows 4..8, train = rows 1..4").find("end `train` at row 3") != std::string::npos);
  CHECK(with_split("test = rows 4..8\nsplit train = rows 1..6").find("rows 4 to 6 are in both ranges `test` and `train`") !=
        std::string::npos);
  CHECK(with_split("a = rows 1..4, b = rows 1..4").find("E4116") != std::string::npos);
}

TEST_CASE("parts apart, and parts inside others, are none of that") {
  CHECK(with_split("train = rows 1..4, test = rows 5..8").empty());
  CHECK(with_split("late = rows 9..12, early = rows 1..4").empty());
  CHECK(with_split("ramp = rows 1..220, cycles = rows 221..292, clean = rows 1..292, one = rows 100..100").empty());
}
