// Spike and slab: probabilities of supports, exact for small dictionaries, sampled for large ones.
#pragma once
#include <span>

#include "regression/choice/selector.hpp"

namespace sysid::regression::spike_slab {

std::span<SettingRow const> settings();

/// Weighs supports by evidence (log_bayes_factor with g, default the number of rows) times prior: `beta_binomial` gives every size
/// the same probability (Scott and Berger 2010), `uniform` every support. Up to `enumerate` selectable terms every support is
/// weighed; beyond, Gibbs chains with swaps, from several starts, find those that matter, and probabilities are those among all
/// supports that a chain has weighed. A term is kept when its inclusion probability is above `keep`.
Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context);

}  // namespace sysid::regression::spike_slab
