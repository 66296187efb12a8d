// Lanes divided among ranks.
#include "simulate/shared_work.hpp"

#include <doctest/doctest.h>

#include <set>
#include <utility>

using namespace sysid;

namespace {

Work batch(int width, int grain) {
  Work work;
  work.width = width;
  work.grain = grain;
  return work;
}

}  // namespace

TEST_CASE("every lane falls to one rank, in whole grains") {
  std::vector<Work> const work = {batch(13, 4), batch(1, 4), batch(0, 4), batch(64, 1), batch(3, 1), batch(100, 4)};
  for (int const ranks : {1, 2, 3, 7, 16, 200}) {
    std::set<std::pair<std::size_t, int>> seen;
    for (int r = 0; r < ranks; ++r) {
      std::vector<LaneRange> const lanes = lanes_of_rank(work, r, ranks);
      REQUIRE(lanes.size() == work.size());
      for (std::size_t i = 0; i < work.size(); ++i) {
        if (lanes[i].count > 0) CHECK(lanes[i].first % work[i].grain == 0);
        for (int w = 0; w < lanes[i].count; ++w) CHECK(seen.emplace(i, lanes[i].first + w).second);
      }
    }
    CHECK(seen.size() == 13 + 1 + 64 + 3 + 100);
  }
}

TEST_CASE("pieces of one lane go round") {
  std::vector<Work> const work(8, batch(1, 4));
  for (int r = 0; r < 4; ++r) {
    int count = 0;
    for (LaneRange const& each : lanes_of_rank(work, r, 4)) count += each.count;
    CHECK(count == 2);
  }
}
