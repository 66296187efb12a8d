// Chains begin around modes, wider than the posterior, and at every mode of notable mass.
#include "search/global/chain_starts.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <set>

#include "inference/targets.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

namespace {

Mode mode_with_share(double share) {
  Mode mode;
  mode.share = share;
  return mode;
}

}  // namespace

TEST_CASE("chains are spread over modes by mass, and a notable mode is never left out") {
  std::vector<Mode> const two = {mode_with_share(0.97), mode_with_share(0.03)};
  CHECK(spread_over_modes(two, 4) == std::vector<int>{0, 0, 0, 1});
  CHECK(spread_over_modes(two, 1) == std::vector<int>{0});
  std::vector<Mode> const even = {mode_with_share(0.5), mode_with_share(0.5)};
  CHECK(spread_over_modes(even, 4) == std::vector<int>{0, 0, 1, 1});
  std::vector<Mode> const faint = {mode_with_share(0.995), mode_with_share(0.005)};
  CHECK(spread_over_modes(faint, 4) == std::vector<int>{0, 0, 0, 0});
}

TEST_CASE("starts are wider than the posterior and differ from each other") {
  TestTarget const target({"x"}, {{Prior::normal, 0, 30}}, 1, 500,
                          [](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = (w[0] - 3) / 0.5; });
  Bench bench;
  SearchResult const result = search(target, ObjectiveKind::posterior, bench.context);
  constexpr int chains = 400;
  LaneArray const starts = overdispersed_starts(target, result.modes, std::vector<int>(chains, 0), bench.context);
  double square = 0;
  std::set<double> distinct;
  for (double const x : starts.row(0)) {
    square += (x - 3) * (x - 3) / chains;
    distinct.insert(x);
  }
  CHECK(distinct.size() == chains);
  CHECK(std::sqrt(square) == doctest::Approx(1.5).epsilon(0.15));  // three sds; standard error 3.5 %
}

TEST_CASE("a mode whose covariance rounding leaves without volume gives starts all the same, along its axes") {
  TestTarget const target({"a", "b"}, {{Prior::normal, 0, 1}, {Prior::normal, 0, 1}}, 1, 0,
                          [](std::vector<double> const& p, std::vector<double>& rows) { rows[0] = p[0] - p[1]; });
  Mode mode;
  mode.theta = mode.declared = {0.5, 0.5};
  mode.covariance = {1, 1, 1, 1 - 1e-12};  // not positive definite
  mode.share = 1;
  Bench bench;
  LaneArray const starts = overdispersed_starts(target, {mode}, std::vector<int>(100, 0), bench.context);
  for (int p = 0; p < 2; ++p) {
    double square = 0;
    for (double const x : starts.row(p)) square += (x - 0.5) * (x - 0.5) / 100;
    CHECK(std::sqrt(square) == doctest::Approx(3).epsilon(0.3));  // three sds of 1; standard error 7 %
  }
}
