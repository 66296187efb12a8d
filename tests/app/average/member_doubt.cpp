// How much the findings of a fit matter in an average.
#include "app/average/member_doubt.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("a fit with warnings and next to no weight is a note of the average, a failed one stays a warning") {
  CHECK(doubt_of_member(Severity::warning, 0.9) == Severity::warning);
  CHECK(doubt_of_member(Severity::warning, 0.001) == Severity::warning);
  CHECK(doubt_of_member(Severity::warning, 3.2e-37) == Severity::note);
  CHECK(doubt_of_member(Severity::warning, 0) == Severity::note);
  CHECK(doubt_of_member(Severity::error, 0.9) == Severity::error);
  CHECK(doubt_of_member(Severity::error, 0.05) == Severity::warning);
  CHECK(doubt_of_member(Severity::error, 3.2e-37) == Severity::warning);
}

TEST_CASE("trajectories of a member with little weight are no error of the average") {
  CHECK(doubt_of_trajectories(Severity::error, 0.5) == Severity::error);
  CHECK(doubt_of_trajectories(Severity::error, 0.05) == Severity::warning);
  CHECK(doubt_of_trajectories(Severity::warning, 0.05) == Severity::note);
  CHECK(doubt_of_trajectories(Severity::error, 0.005) == Severity::note);
}
