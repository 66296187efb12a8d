// Reversible jumps between models: chains over models and their parameters, by likelihood.
#pragma once
#include "inference/backend/selector.hpp"

namespace sysid::jump {

/// Green 1995, with proposals that pilots have learnt (Hastie and Green 2012, sec. 4): after a pilot of each model, chains whose
/// moves are jumps (a model at random, parameters from its mixture) and walks. The density is divided by factors that make visits
/// even, which the probabilities take back; they come from how likely jumps are accepted (Bartolucci, Scaccia and Mira 2006). Each
/// move depends on its chain and number alone, so threads, lanes and interruptions change nothing.
SelectionResult run(std::span<LikelihoodCandidate const> candidates, Settings const& settings, RunContext& context);

}  // namespace sysid::jump
