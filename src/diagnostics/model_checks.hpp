// What a finished fit is asked apart from its residuals: does a population upset it, is every parameter used.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "data/start_rule.hpp"
#include "likelihood/model_target.hpp"
#include "result/report.hpp"

namespace sysid {

/// What an estimated spread of a population does to a result (docs/methods/several_experiments.md): to chains, when `found` says
/// that they have not mixed, and to an optimum of the posterior, whose density may grow without bound where the spread vanishes.
/// non_centred: names of parameters that are sampled relative to their population, where a small spread does not slow chains.
Findings check_hierarchy(Model const& model, Draws const& draws, Findings const& found,
                         std::span<std::string const> non_centred = {});

/// Of an optimum of the likelihood, which does not contain them: parameters that only priors of others read.
Findings check_populations(Model const& model);

/// Parameters with a prior that nothing in the model uses: their posterior is their prior.
Findings check_use(Model const& model, StartRule const& start);

/// `flat_direction`, a warning, of draws: parameters on which the log likelihood does not depend. At 24 draws, spread over all,
/// each takes a value from its prior, and no log likelihood changes by more than 1e-6. Nothing is looked at that is a coefficient,
/// or that priors of others read; nor an expensive or an estimated likelihood, nor one with an improper prior. draws: declared
/// values of the parameters of the target, one vector each.
Findings check_influence(Model const& model, Target const& target, std::vector<std::vector<double>> const& draws);

}  // namespace sysid
