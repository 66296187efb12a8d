// A gain is steady where every part of a record has its share of it, by how much the inputs differ there.
#include "diagnostics/inputs/steady_gain.hpp"

#include <doctest/doctest.h>

#include "core/numeric/random.hpp"

using namespace sysid;

TEST_CASE("a gain at the few changes of an input is steady, however uneven along the record") {
  // The input changes at every 20th row, by different amounts; the gain follows within three rows.
  Stream stream({1, Purpose::test, 0, 0});
  std::vector<double> gains(400, 0.0), differences(400, 0.0), by_chance(400, 0.0);
  for (std::size_t k = 20; k + 3 < gains.size(); k += 20) {
    double const change = stream.normal();
    differences[k] = change * change;
    for (std::size_t after = 0; after < 3; ++after) {
      gains[k + after] = change * change + 0.3 * change * stream.normal();
      by_chance[k + after] = change * stream.normal();
    }
  }
  CHECK(steady_gain(gains, differences));
  CHECK_FALSE(steady_gain(by_chance, differences));
}

TEST_CASE("a gain in a few places, of few changes or of none is not steady") {
  std::vector<double> const even(400, 1.0);
  std::vector<double> once(400, 0.0), changes(400, 0.0);
  for (std::size_t k = 100; k < 150; ++k) once[k] = 1;
  CHECK_FALSE(steady_gain(once, even));
  CHECK(steady_gain(even, even));
  for (std::size_t k = 50; k < 400; k += 60) changes[k] = 1;
  CHECK_FALSE(steady_gain(even, changes));  // six parts
  CHECK_FALSE(steady_gain(even, std::vector<double>(400, 0.0)));
}
