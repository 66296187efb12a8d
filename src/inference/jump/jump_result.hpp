// What jumps and walks have come to: probabilities, evidences and rates of each model, its draws, and findings.
#pragma once
#include <span>
#include <vector>

#include "inference/jump/moves.hpp"
#include "inference/jump/plan.hpp"
#include "inference/jump/state.hpp"
#include "result/selection.hpp"

namespace sysid::jump {

/// models: those of state.live. Fills what is known of these in `result`, whose models have names, priors and parameters.
void fill_result(std::span<LikelihoodCandidate const> candidates, std::vector<Model> const& models, Plan const& plan,
                 State const& state, SelectionResult& result);

}  // namespace sysid::jump
