// Walkers that begin in the middle of a density, and where they are after a while.
#include "inference/evidence/ensemble_walk.hpp"

#include <doctest/doctest.h>

#include "core/numeric/statistics.hpp"
#include "inference/evidence/known.hpp"

using namespace sysid;
using sysid::testing::TestTarget;

namespace {

/// A curved ridge: u0 ~ N(0, 1), u1 ~ N(u0^2, 0.3).
double curved_ridge(std::vector<double> const& u) {
  double const off = (u[1] - u[0] * u[0]) / 0.3;
  return -0.5 * u[0] * u[0] - 0.5 * off * off;
}

LaneArray walked(Objective const& objective, int width, int steps) {
  LaneArray walkers(2, width);
  for (int w = 0; w < width; ++w) {
    Stream stream({3, Purpose::test, static_cast<std::uint64_t>(w), 0});
    walkers(0, w) = 0.3 * stream.normal();
    walkers(1, w) = 0.1 * stream.normal();
  }
  Ledger ledger;
  return marginal::walk(objective, walkers, steps, {1, Purpose::test, 0, 1}, ledger, [] { return false; });
}

}  // namespace

TEST_CASE("walkers reach the ends of a curved ridge from its middle, and stay in its density") {
  TestTarget const target = testing::target_of(2, 5, 10, curved_ridge);
  Objective const objective = make_objective(target, ObjectiveKind::posterior, 1, 0);
  LaneArray const states = walked(objective, 400, 200);
  REQUIRE(states.width() == 1200);
  std::vector<double> along, off;
  for (int w = 0; w < states.width(); ++w) {
    along.push_back(states(0, w));
    off.push_back(states(1, w) - states(0, w) * states(0, w));
  }
  // Of 400 independent draws the sd is known to 3.5 %, the mean to 0.05.
  CHECK(mean(along) == doctest::Approx(0).epsilon(0.15));
  CHECK(std::sqrt(sample_variance(along)) == doctest::Approx(1).epsilon(0.12));
  CHECK(std::sqrt(sample_variance(off)) == doctest::Approx(0.3).epsilon(0.12));
}

TEST_CASE("walkers of one key take the same steps, and a request to stop leaves them where they are") {
  TestTarget const target = testing::target_of(2, 5, 10, curved_ridge);
  Objective const objective = make_objective(target, ObjectiveKind::posterior, 1, 0);
  LaneArray const once = walked(objective, 20, 8), again = walked(objective, 20, 8);
  for (int w = 0; w < once.width(); ++w) CHECK(once(0, w) == again(0, w));
  LaneArray walkers(2, 8);
  Ledger ledger;
  LaneArray const still = marginal::walk(objective, walkers, 8, {1, Purpose::test, 0, 1}, ledger, [] { return true; });
  CHECK(still(0, 5) == 0);
}
