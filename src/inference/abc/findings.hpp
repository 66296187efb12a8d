// The findings of an ABC-SMC run about itself.
#pragma once
#include "inference/abc/plan.hpp"
#include "inference/backend/selector.hpp"

namespace sysid::abc {

/// The failure of a run that never filled its first population: how many draws came how far, what ended the run (in words), and
/// which of threshold, priors and budget to change.
/// ledger: of the whole run, which tells where simulations failed.
Finding no_population(PopulationRecord const& record, double threshold, int particles, std::string const& stopped_by,
                      Ledger const& ledger);

/// Models that died by chance, populations that stand on few particles, thresholds that cannot fall, failed simulations, and
/// budgets that ended the run.
Findings check_populations(SelectionResult const& result, Plan const& plan);

}  // namespace sysid::abc
