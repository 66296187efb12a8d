// What a finished fit is asked apart from its residuals: does a population upset it, is every parameter used, would another timing
// of the input fit much better.
#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "data/start_rule.hpp"
#include "likelihood/model_target.hpp"
#include "result/report.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

/// What an estimated spread of a population does to a result (docs/methods/several_experiments.md): to chains, when `found` says
/// that they have not mixed, and to an optimum, whose density may grow without bound where the spread vanishes.
Findings check_hierarchy(Model const& model, Draws const& draws, Findings const& found);

/// Parameters with a prior that nothing in the model uses: their posterior is their prior.
Findings check_use(Model const& model, StartRule const& start);

/// Makes the target of a fit from other experiments.
using TargetOf = std::function<std::unique_ptr<Target>(std::vector<Experiment> experiments)>;

/// A much better fit with an input of one experiment half a sample earlier or later (more than `0.2` nats per scored sample of that
/// experiment, and 20 in all) means that the rule between input samples is not the one of the experiment. experiments: of the fit.
/// mode: the best one of the density that `objective_kind` names.
Findings check_input_timing(TargetOf const& target_of, Model const& model, std::vector<Experiment> const& experiments,
                            ObjectiveKind objective_kind, Mode const& mode, std::uint64_t seed, Ledger& ledger);

}  // namespace sysid
