// How far modes have moved.
#include "search/mode/moves.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "core/numeric/not_finite.hpp"
#include "relative.hpp"

using namespace sysid;

TEST_CASE("a change of width is a move of the limits") {
  Mode narrow, wide;
  narrow.declared = wide.declared = {1, 5};
  narrow.sd = {0.5, 0.1};
  wide.sd = {0.5, 0.3};
  std::vector<ParameterInfo> const free(2, {"", "", -infinity, infinity});
  sysid::Move const move = largest_move(free, narrow, wide, 0);
  CHECK(move.parameter == 1);
  CHECK(move.value == 0);
  CHECK(move.size() == doctest::Approx(2).epsilon(1e-12));
  // Not along a direction that nothing resists, nor at a bound.
  Mode flat = narrow;
  flat.flat = {0, 0.1};
  CHECK(largest_move(free, flat, wide, 0).size() == 0);
  std::vector<ParameterInfo> const bounded = {{"", "", -infinity, infinity}, {"", "", 0, 5}};
  CHECK(largest_move(bounded, narrow, wide, 0).size() == 0);
}

TEST_CASE("where the finer of two modes is flat the sds of the other measure its move") {
  Mode finer, coarser;
  finer.declared = {20, 1};
  finer.sd = {950, 0.1};
  finer.flat = {90, 0};
  coarser.declared = {10, 1};
  coarser.sd = {0.5, 0.1};
  std::vector<ParameterInfo> const free(2, {"", "", -infinity, infinity});
  CHECK(largest_move(free, finer, coarser, 300).size() == doctest::Approx(20).epsilon(1e-12));
  CHECK(largest_move(free, finer, coarser, 12).size() == doctest::Approx(std::sqrt(24)).epsilon(1e-12));  // as the gain allows
  coarser.flat = finer.flat;
  CHECK(largest_move(free, finer, coarser, 0.4).size() == relative(10.0 / 950, 1e-12));
  CHECK(largest_move(free, finer, coarser, 8).size() == doctest::Approx(4).epsilon(1e-12));  // which the flat direction hides
}
