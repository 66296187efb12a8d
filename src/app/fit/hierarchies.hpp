// Hierarchies whose members are sampled relative to their population, in words.
#pragma once
#include <string>
#include <vector>

#include "likelihood/parameter_space.hpp"

namespace sysid {

/// The parameters of the model that such members are of: "k", "c[1]".
std::vector<std::string> parameters_of(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised);

/// The names under which these are declared, each once: "k", "c".
std::vector<std::string> declared_names(std::vector<std::string> const& parameters);

/// The notice about them; a whole line.
std::string standardised_notice(std::vector<std::string> const& names);

}  // namespace sysid
