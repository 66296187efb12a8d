// The order of particles along a curve, and the choice among them.
#include "likelihood/particle/resampling.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>

#include "core/numeric/random.hpp"

using namespace sysid;

TEST_CASE("resampling: the curve visits every cell once, and goes from neighbour to neighbour") {
  for (int const axes : {2, 3}) {
    int const bits = 3, cells = 1 << (bits * axes);
    std::vector<std::uint16_t> points(static_cast<std::size_t>(axes * cells)), places(static_cast<std::size_t>(cells));
    for (int a = 0; a < axes; ++a)
      for (int cell = 0; cell < cells; ++cell)
        points[static_cast<std::size_t>(a * cells + cell)] = static_cast<std::uint16_t>((cell >> (a * bits)) & 7);
    std::vector<std::uint16_t> moved = points;
    hilbert_places(moved, axes, bits, places);
    std::map<int, std::vector<int>> by_place;
    for (int cell = 0; cell < cells; ++cell)
      for (int a = 0; a < axes; ++a)
        by_place[places[static_cast<std::size_t>(cell)]].push_back(points[static_cast<std::size_t>(a * cells + cell)]);
    REQUIRE(by_place.size() == static_cast<std::size_t>(cells));
    CHECK(by_place.rbegin()->first == cells - 1);
    for (auto next = std::next(by_place.begin()); next != by_place.end(); ++next) {
      int steps = 0;
      for (std::size_t a = 0; a < next->second.size(); ++a) steps += std::abs(next->second[a] - std::prev(next)->second[a]);
      CHECK(steps == 1);
    }
  }
}

TEST_CASE("resampling: of one state that moves the order is its own, whatever is not finite") {
  int const count = 500;
  LaneArray states(3, count);
  Stream stream(StreamKey{.seed = 8});
  for (int w = 0; w < count; ++w) states(0, w) = 4, states(1, w) = stream.normal(), states(2, w) = -1;
  states(1, 17) = std::nan("");
  states(1, 30) = HUGE_VAL;
  ParticleOrder order(count);
  std::span<int const> const found = order(states);
  REQUIRE(found.size() == static_cast<std::size_t>(count));
  std::vector<int> seen(found.begin(), found.end());
  std::sort(seen.begin(), seen.end());
  for (int w = 0; w < count; ++w) CHECK(seen[static_cast<std::size_t>(w)] == w);
  double before = -HUGE_VAL;
  for (int const particle : found) {
    if (particle == 17 || particle == 30) continue;
    CHECK(before <= states(1, particle) + 8.0 / 65536 * 1.2);  // a cell of the curve
    before = states(1, particle);
  }
}

TEST_CASE("resampling: every particle has its share of descendants, rounded, and those without weight have none") {
  std::array const weights = {0.0, 1.0, 0.05, 0.35, 0.0, 0.6};
  std::array const order = {4, 2, 0, 5, 1, 3};
  for (double const uniform : {1e-9, 0.3, 0.5, 0.99999999}) {
    std::array<int, 40> ancestors{};
    systematic_ancestors(weights, order, uniform, ancestors);
    std::array<int, 6> count{};
    for (int const each : ancestors) ++count[static_cast<std::size_t>(each)];
    for (std::size_t i = 0; i < weights.size(); ++i) CHECK(std::fabs(count[i] - 20 * weights[i]) < 1);
    for (std::size_t k = 1; k < ancestors.size(); ++k)
      CHECK(std::find(order.begin(), order.end(), ancestors[k - 1]) <= std::find(order.begin(), order.end(), ancestors[k]));
  }
}
