// The evidence as a function of the widths of the priors, from draws of one posterior.
#pragma once
#include <vector>

#include "result/prior_width.hpp"
#include "result/report.hpp"

namespace sysid {

/// With a prior p_f in place of p the evidence is Z_f, and the mean is over draws of the posterior under p:
///
///   Z_f / Z = E[p_f(theta) / p(theta)]
///
/// For every prior that is stated in numbers and has a width, one by one, and for all together: half and a quarter, twice and four
/// times as wide. The error is that of the mean of correlated draws. No change where fewer than 50 independent ratios are left (a
/// posterior in the tail of its prior), where their variance is infinite by Pareto's k above 1/2 (a posterior hardly narrower than
/// its prior), or where the posterior lies against a bound beyond which the wider prior goes on. draws:
/// parameters in declared units; nothing for a single draw.
std::vector<PriorWidth> prior_widths(std::vector<PriorInfo> const& priors, Draws const& draws);

}  // namespace sysid
