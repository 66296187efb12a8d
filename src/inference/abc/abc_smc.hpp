// Approximate Bayesian computation by sequential Monte Carlo over models and parameters: the tutorial's Algorithm 1, with the
// weights that it needs.
#pragma once
#include "inference/backend/selector.hpp"

namespace sysid::abc {

/// Population 1: draws from the priors over models and parameters whose distance is within the first threshold. Population t: a
/// model is drawn, a particle of it, moved by the kernel; accepted when its prior is positive and its distance within a falling
/// threshold. The first `particles` accepted proposals, by number, make a population, so threads, lanes and interruptions change
/// nothing. Toni and Stumpf 2010 (models), Filippi et al. 2013 (kernels).
SelectionResult run(SelectionTarget const& candidates, Settings const& settings, RunContext& context);
/// The same with at least so many proposals simulated at once, where a population needs as many: what many ranks do.
SelectionResult run_wide(SelectionTarget const& candidates, Settings const& settings, RunContext& context, int at_once);

}  // namespace sysid::abc
