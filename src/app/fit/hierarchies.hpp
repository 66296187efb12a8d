// Hierarchies whose members are sampled relative to their population, in words.
#pragma once
#include <string>
#include <vector>

#include "likelihood/parameter_space.hpp"

namespace sysid {

/// The names of the model's parameters that such members are of: "k, c".
std::string names_of(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised);

/// The notice about them; a whole line.
std::string standardised_notice(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised);

}  // namespace sysid
