// Reversible jumps between sets of terms: the posterior of `spike_slab`, sampled instead of summed, with errors.
#pragma once
#include <span>
#include <string>

#include "regression/choice/selector.hpp"

namespace sysid::regression::reversible_jump {

std::span<SettingRow const> settings();
std::string refuse(Settings const& settings);

/// Chains over sets of terms, their coefficients, the noise variance and, with `beta_prime`, g. A move adds a term, removes one or
/// exchanges two, and proposes all coefficients of the new set from their normal distribution given noise and g; for that choice
/// the ratio of Green (1995) is
///
///   p(y | new, sigma, g) p(g | new) p(new) / (the same of the old set)                                    Godsill 2001, sec. 3
///
/// since density and proposal of the coefficients divide to their integral. Noise and g are drawn from their conditional
/// distributions in between. Probabilities are parts of the iterations; their errors are those of means over parts of the chains.
Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context);

}  // namespace sysid::regression::reversible_jump
