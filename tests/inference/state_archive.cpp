// What is kept of the states of chains, and what is picked from it.
#include "inference/chain/state_archive.hpp"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <set>

#include "inference/backend/checkpoint.hpp"

using namespace sysid;
using namespace sysid::metropolis;

namespace {

/// Four chains; a state is its iteration and its chain.
StateArchive filled(std::uint64_t iterations) {
  StateArchive archive(2);
  LaneArray theta(2, 4);
  for (std::uint64_t i = 0; i < iterations; ++i) {
    for (int w = 0; w < 4; ++w) theta(0, w) = static_cast<double>(i), theta(1, w) = w;
    for (int w = 0; w < 4; ++w) archive.add(theta, w, i);
    archive.thin();
  }
  return archive;
}

}  // namespace

TEST_CASE("states are picked of all chains alike, in order, wherever the count is a multiple of them") {
  for (std::uint64_t const iterations : {704, 712, 1266, 2048, 5000}) {
    CAPTURE(iterations);
    StateArchive const archive = filled(iterations);
    for (std::size_t const most : {16, 64, 500}) {
      LaneArray const picked = archive.picked(archive.early(), most);
      REQUIRE(picked.width() == static_cast<int>(most));
      double of_chain[4] = {};
      for (int n = 0; n < picked.width(); ++n) {
        of_chain[static_cast<int>(picked(1, n))] += 1;
        if (n > 0) CHECK(picked(0, n) >= picked(0, n - 1));
      }
      for (double const count : of_chain) CHECK(4 * count == static_cast<double>(most));
      CHECK(picked(0, 0) >= static_cast<double>(iterations) / 3 - 8);
    }
  }
}

TEST_CASE("an archive that is full keeps whole iterations at twice the interval, and is the same when it is read back") {
  StateArchive const archive = filled(3000);
  CHECK(archive.size() < 8192);
  LaneArray const all = archive.picked(0, archive.size());
  std::set<double> iterations;
  for (int n = 0; n < all.width(); ++n) {
    iterations.insert(all(0, n));
    CHECK(all(1, n) == n % 4);
  }
  CHECK(iterations.size() * 4 == archive.size());
  CHECK(*std::next(iterations.begin()) == 2);
  StateArchive const again = StateArchive::restore(archive.store(), 2);
  CHECK(again.store() == archive.store());
  CHECK_THROWS_AS(StateArchive::restore(archive.store(), 3), checkpoint::Mismatch);
  CHECK(StateArchive(2).picked(0, 64).width() == 0);
}
