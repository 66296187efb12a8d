// The choice of vector instructions.
#include "core/numeric/instruction_set.hpp"

#include <doctest/doctest.h>

using namespace sysid;

TEST_CASE("the set in force is the best one until another is forced") {
  REQUIRE(supported_instruction_set().has_value());
  InstructionSet const best = instruction_set();
  CHECK(best == *supported_instruction_set());
  force_instruction_set(narrowest_instruction_set);
  CHECK(instruction_set() == narrowest_instruction_set);
  force_instruction_set(best);
  CHECK(name(InstructionSet::avx2) == "avx2");
  CHECK(name(InstructionSet::avx512) == "avx512");
  CHECK(name(InstructionSet::neon) == "neon");
}
