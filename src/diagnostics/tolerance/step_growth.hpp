// Whether steps of a given length follow a linear motion over the prior, or grow where it does not.
#pragma once
#include <vector>

#include "data/experiment.hpp"
#include "likelihood/parameter_space.hpp"
#include "solver/solver.hpp"

namespace sysid {

/// The share of the prior for which the fixed steps of a method grow without bound along a record though the motion does not: there
/// the largest factor by which a step multiplies a part of the states, the largest eigenvalue of
///
///   R(z) = 1 + z + z^2/2 + ... + z^p/p!,   z = hA, p the order of the method        Hairer & Wanner 1996, section IV.2
///
/// is above 1 and above that of exp(z). Models that are linear in their states with coefficients of parameters alone, whose priors
/// are proper; 0 for methods that are no fixed step. Takes 256 draws, the same ones whatever the task's seed.
double share_of_growing_steps(ParameterSpace const& space, std::vector<Experiment> const& experiments,
                              SolverSettings const& solver);

}  // namespace sysid
