// Whether a posterior is concentrated at a bound of its prior, so that the bound determines the result.
#pragma once
#include <span>
#include <string>

#include "likelihood/target.hpp"
#include "result/draws.hpp"
#include "result/finding.hpp"
#include "result/report.hpp"

namespace sysid {

struct BoundCheck {
  bool at_lower = false, at_upper = false;
};

struct BoundRule {
  bool logarithmic = true;    // on a log scale when both bounds are positive and a decade or more apart
  bool also_natural = false;  // not silent about a bound of 0 alone: zero below a scale parameter is natural, not a choice
};

/// Piles up at a bound: the density of the draws there is at least half its peak, while their central 90 % is narrower than half
/// the prior (a posterior as wide as its prior does not pile up, it has learnt nothing). Density: share of draws in a window of a
/// tenth of the central 90 %. prior_spread: the central 90 % of a prior with one bound only; infinite where it is improper, 0 where
/// it is not known.
BoundCheck check_bounds(std::span<double const> draws, double lower, double upper, double prior_spread = 0, BoundRule rule = {});

/// What to say of a parameter at a lower bound that is not negative, against which a wrong sign drives it: a prior cannot be
/// widened below a bound of 0 without another distribution, and behind a smaller positive bound lies the next one.
std::string wrong_sign_at_bound(std::string const& parameter, double lower);

/// One warning per parameter that piles up, over all chains. priors: of the parameters, by name. explains_nothing: the fit, which a
/// parameter that is kept from the other sign by a bound of 0 may be the cause of.
Findings check_bounds(std::span<ParameterInfo const> parameters, Draws const& draws, std::span<PriorInfo const> priors = {},
                      bool explains_nothing = false);

}  // namespace sysid
