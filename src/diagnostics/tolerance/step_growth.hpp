// Whether steps of a given length follow a linear motion over the prior, or grow where it does not.
#pragma once
#include <vector>

#include "data/experiment.hpp"
#include "likelihood/parameter_space.hpp"
#include "solver/solver.hpp"

namespace sysid {

/// The share of the prior for which the fixed steps of a method grow without bound along a record though the motion does not: there
/// a step multiplies a part of the states by
///
///   |R(z)|,   R(z) = 1 + z + z^2/2 + ... + z^p/p!,   z an eigenvalue of hA, p the order   Hairer & Wanner 1996, section IV.2
///
/// which is above 1 and above |exp(z)|, by 1 % each. Models that are linear in their states with coefficients of parameters alone,
/// whose priors are proper; 0 for methods that are no fixed step. Takes 256 draws, the same ones whatever the task's seed.
double share_of_growing_steps(ParameterSpace const& space, std::vector<Experiment> const& experiments,
                              SolverSettings const& solver);

}  // namespace sysid
