// A prior as numbers: taken from a checked model, and turned into the density and the interval that reports show.
#pragma once
#include "model/model.hpp"
#include "result/report.hpp"

namespace sysid {

/// The numbers of a parameter's prior, SI; nothing when they depend on other parameters.
std::optional<PriorNumbers> prior_numbers(Parameter const& parameter, Model const& model);

/// Fills in the density and the 5 and 95 % quantiles (declared unit) that follow from the numbers; the quantiles are left out where
/// the distribution has none.
void add_density(PriorInfo& prior);

}  // namespace sysid
