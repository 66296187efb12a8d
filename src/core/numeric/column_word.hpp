// A column of numbers as one word.
#pragma once
#include <cstdint>

#include "core/numeric/lanes.hpp"

namespace sysid {

/// The bits of a parameter vector: another word for almost any other vector, so that it can name a stream of random numbers.
std::uint64_t word_of(ConstLanes theta, int lane);

}  // namespace sysid
