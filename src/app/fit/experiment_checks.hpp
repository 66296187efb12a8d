// Whether the experiments of a fit agree on the parameters that they share.
#pragma once
#include <string>

#include "app/fit/fit_checks.hpp"

namespace sysid {

/// Why shared parameters are not compared between experiments; empty: they are.
std::string without_shared_parameters(FinishedFit const& fit);

/// The mode of the fit is followed to the target of each experiment alone, under the same prior. Where estimates of a shared
/// parameter lie more than six of their sds apart, and all experiments alone are clearly better described than together, they
/// disagree: a parameter that is not the same in all, a clock, a unit or a sensor that is another. Sds and likelihoods count
/// residuals that are not white as the independent ones that they are worth. The most distant parameter is named first.
Findings check_shared_parameters(FinishedFit& fit);

}  // namespace sysid
