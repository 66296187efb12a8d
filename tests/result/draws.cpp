// Draws that stand for all: spread evenly over the chains, never more of one than of another by two.
#include "result/draws.hpp"

#include <doctest/doctest.h>

#include <map>

using namespace sysid;

namespace {

// Chains of 3 and 4 draws of one parameter, 0 to 6.
Draws seven_draws() {
  Draws draws;
  draws.names = {"a"};
  draws.parameter_count = 1;
  draws.chains.resize(2);
  for (int i = 0; i < 7; ++i) draws.chains[i < 3 ? 0 : 1].values.push_back({static_cast<double>(i)});
  return draws;
}

std::map<double, int> counted(LaneArray const& columns) {
  std::map<double, int> count;
  for (int w = 0; w < columns.width(); ++w) ++count[columns(0, w)];
  return count;
}

}  // namespace

TEST_CASE("fewer draws than there are are spread over all chains, each once") {
  auto const count = counted(spread(seven_draws(), 3));
  CHECK(count == std::map<double, int>{{1, 1}, {3, 1}, {5, 1}});
  CHECK(counted(spread(seven_draws(), 100)).size() == 7);
  CHECK(spread(seven_draws(), 100).width() == 7);
}

TEST_CASE("a share that is larger than the number of draws repeats them evenly") {
  LaneArray const columns = spread_with_repeats(seven_draws(), 17);
  CHECK(columns.width() == 17);
  for (auto const& [value, times] : counted(columns)) {
    CAPTURE(value);
    CHECK((times == 2 || times == 3));
  }
  CHECK(counted(columns).size() == 7);
  CHECK(spread_with_repeats(seven_draws(), 0).width() == 0);
}
