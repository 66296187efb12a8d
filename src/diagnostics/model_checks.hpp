// Checks of a finished fit other than those of its residuals: populations, unused parameters.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "data/start_rule.hpp"
#include "model/model.hpp"
#include "result/report.hpp"

namespace sysid {

/// What an estimated spread of a population does to a result (docs/methods/several_experiments.md): to chains, when `found` says
/// that they have not mixed, and to an optimum of the posterior, whose density may grow without bound where the spread vanishes.
/// non_centred: names of parameters that are sampled relative to their population, where a small spread does not slow chains.
Findings check_hierarchy(Model const& model, Draws const& draws, Findings const& found,
                         std::span<std::string const> non_centred = {});

/// Of an optimum of the likelihood, which does not contain them: parameters that only priors of others read.
Findings check_populations(Model const& model);

/// Parameters with a prior that nothing in the model uses: their posterior is their prior. optimum: what is shown of them is where
/// the search left them. switched_off: whether the text of the model reads a parameter where arguments of the model may have taken
/// the term out; null: the model has no arguments.
Findings check_use(Model const& model, StartRule const& start, std::function<bool(std::string const& name)> const& switched_off,
                   bool optimum = false);

/// Where a fit explains little: adds to the help which parameters the model fixes at a negative value, as a damping with the wrong
/// sign.
void name_negative_values(Model const& model, Findings& findings);

}  // namespace sysid
