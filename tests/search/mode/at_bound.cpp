// Modes at bounds of priors, by what is known of the mode alone and by the density on the way to the bound.
#include "search/mode/at_bound.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "inference/targets.hpp"
#include "search/global/search.hpp"

using namespace sysid;
using namespace sysid::testing;

TEST_CASE("a bound is reached within a thousandth of the support, or of a positive lower bound") {
  CHECK(at_bound({"", "", 0, 1}, 0.9995, 0.1));
  CHECK_FALSE(at_bound({"", "", 0, 1}, 0.998, 0.1));
  CHECK(at_bound({"", "", 1e-3, 1}, 1.0005e-3, 0.1));
  CHECK_FALSE(at_bound({"", "", 1e-3, 1}, 1.1e-3, 0.1));
  CHECK_FALSE(at_bound({"", "", -infinity, infinity}, 1e300, 0.1));
  // Nine sds from the end of a wide support, and where the sd is not known.
  CHECK_FALSE(at_bound({"", "", 0, 1000}, 0.28, 0.03));
  CHECK(at_bound({"", "", 0, 1000}, 0.28, 0));
}

TEST_CASE("one bound alone is reached within a tenth of an sd") {
  CHECK(at_bound({"", "", 3.4, infinity}, 3.4 + 1e-12, 2e-11));
  CHECK(at_bound({"", "", 3.4, infinity}, 3.4, 0));
  CHECK_FALSE(at_bound({"", "", 3.4, infinity}, 3.4 + 1e-9, 2e-9));
  CHECK(at_bound({"", "", -infinity, 0}, -1e-12, 2e-11));
}

TEST_CASE("a mode is at a bound if its density does not fall on the way there, however wide the support is") {
  // N(x | centre, 1) under uniform(0, upper): the density at the bound is that of the mode times exp(-centre^2/2).
  for (double const upper : {20.0, 1e7})
    for (double const centre : {-1.0, 0.0, 0.1, 1.0, 9.0}) {
      CAPTURE(upper);
      CAPTURE(centre);
      TestTarget const target({"x"}, {{Prior::uniform, 0, upper}}, 1, 0,
                              [=](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = w[0] - centre; });
      Bench bench;
      Mode const mode = search(target, ObjectiveKind::declared_posterior, bench.context).modes.front();
      std::vector<ModeAtBound> const bounds =
          modes_at_bounds(make_objective(target, ObjectiveKind::declared_posterior, 1, 1), mode);
      REQUIRE(bounds.size() == (centre <= 0 ? 1 : 0));
      if (centre > 0) continue;
      CHECK(bounds[0].parameter == 0);
      CHECK_FALSE(bounds[0].upper);
      CHECK_FALSE(bounds[0].unbounded);
    }
}

TEST_CASE("a density that ends at the bound has a maximum there, however steeply it rises") {
  // Rows k*(x - 1000.5) under uniform(0, 1000): the density at the bound is finite, and rises there by k^2/2 per unit.
  for (double const steepness : {1e3, 1e6, 1e9}) {
    CAPTURE(steepness);
    TestTarget const target({"x"}, {{Prior::uniform, 0, 1000}}, 1, 0, [=](std::vector<double> const& w, std::vector<double>& rows) {
      rows[0] = std::sqrt(steepness) * (w[0] - 1000.5);
    });
    Bench bench;
    Mode const mode = search(target, ObjectiveKind::declared_posterior, bench.context).modes.front();
    std::vector<ModeAtBound> const bounds = modes_at_bounds(make_objective(target, ObjectiveKind::declared_posterior, 1, 1), mode);
    REQUIRE(bounds.size() == 1);
    CHECK(bounds[0].upper);
    CHECK_FALSE(bounds[0].unbounded);
  }
}

TEST_CASE("a parameter that changes nothing is not at a bound, wherever the search has left it") {
  for (double const effect : {1e-6, 1.0}) {
    TestTarget const target({"x"}, {{Prior::uniform, 0, 1000}}, 1, 0,
                            [=](std::vector<double> const& w, std::vector<double>& rows) { rows[0] = effect * (w[0] + 1); });
    Objective const objective = make_objective(target, ObjectiveKind::declared_posterior, 1, 1);
    Mode mode;
    mode.declared = {1e-3};
    mode.theta = {std::log(1e-6 / (1 - 1e-6))};
    CHECK(modes_at_bounds(objective, mode).size() == (effect < 1 ? 0 : 1));
  }
}
