// Hierarchies whose members are sampled relative to their population, in words.
#pragma once
#include <string>
#include <vector>

#include "likelihood/parameter_space.hpp"
#include "result/finding.hpp"

namespace sysid {

/// The parameters of the model that such members are of: "k", "c[1]".
std::vector<std::string> parameters_of(ParameterSpace const& space, std::vector<MemberCoordinate> const& standardised);

/// The names under which these are declared, each once: "k", "c".
std::vector<std::string> declared_names(std::vector<std::string> const& parameters);

/// The notice about them; a whole line.
std::string standardised_notice(std::vector<std::string> const& names);

/// A `flat_direction` of a hierarchy that is written as `mean + spread*z` becomes a note: its proper priors separate these
/// parameters, as they are meant to.
void excuse_hierarchies(ParameterSpace const& space, Findings& findings);

}  // namespace sysid
