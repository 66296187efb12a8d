// Budgets of memory.
#include "core/system/memory.hpp"

#include <doctest/doctest.h>

#include <new>

#include "core/numeric/lanes.hpp"
#include "core/text/diagnostic.hpp"

using namespace sysid;

TEST_CASE("bytes are told in units of three digits at most") {
  CHECK(format_bytes(0) == "0 B");
  CHECK(format_bytes(512) == "512 B");
  CHECK(format_bytes(1000) == "1.0 kB");
  CHECK(format_bytes(9940) == "9.9 kB");
  CHECK(format_bytes(123456) == "123 kB");
  CHECK(format_bytes(2.44e9) == "2.4 GB");
}

TEST_CASE("numbers of a simulation are counted, or refused where they are too many") {
  CHECK(recorded_numbers(1000000, 2000) == 2000000000);
  CHECK(recorded_numbers(0, 5) == 0);
  CHECK_THROWS_AS(recorded_numbers(1000000, 2200), UserError);
}

TEST_CASE("more memory than there is is refused with both figures, a little is not") {
  CHECK(free_memory() > 1e6);
  CHECK_NOTHROW(require_memory("reading `a.csv`", 1000, "cut it"));
  try {
    require_memory("reading `a.csv`", 4e18, "cut it");
    FAIL("let through");
  } catch (UserError const& error) {
    CHECK(error.diagnostic().code == "E5003");
    CHECK(error.diagnostic().message.starts_with("reading `a.csv` needs about 4000 PB of memory, and "));
    CHECK(error.diagnostic().help == "cut it");
  }
}

TEST_CASE("a block of lanes that cannot be had is an exception, not a null pointer") {
  CHECK_THROWS_AS(LaneArray(1 << 30, 1 << 24), std::bad_alloc);
  CHECK_THROWS_AS(LaneArray(-1, 8), std::bad_alloc);  // samples times quantities beyond the range of int
  CHECK(LaneArray(0, 8).rows() == 0);
}
