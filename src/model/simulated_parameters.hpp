// Which parameters a simulation without noise reads: the others are those of the noise.
#pragma once
#include <string>
#include <vector>

#include "model/model.hpp"

namespace sysid {

/// Per parameter: whether states, their starts or the centre of a channel depend on it, or the prior of one that they depend on.
std::vector<bool> simulated_parameters(Model const& model);

/// Per parameter: whether a simulation or the noise of a channel depends on it. No sample says anything of the others.
std::vector<bool> measured_parameters(Model const& model);

/// Derived quantities that depend on a parameter that a simulation without noise does not read: it cannot say them.
std::vector<std::string> derived_from_noise(Model const& model);

/// The model with a value (1, which nothing reads) in place of the prior of every other parameter: its priors are those of a
/// simulation without noise.
Model without_noise_parameters(Model model);

}  // namespace sysid
