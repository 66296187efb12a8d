// Whether the experiments of a fit resemble each other, as members of one population do.
#pragma once
#include "likelihood/parameter_space.hpp"
#include "result/draws.hpp"
#include "result/finding.hpp"

namespace sysid {

/// Members that the others do not resemble, up to a quarter of them, by draws of theirs against those of the others: such members
/// widen the population until they look usual in it. At least five members; by the tail of Student's t distribution.
Findings check_members(ParameterSpace const& space, Draws const& draws);

}  // namespace sysid
