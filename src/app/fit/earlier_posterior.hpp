// The posterior of the rows before one of them, where draws of the whole posterior are too far from it to be weighted.
#pragma once
#include <optional>

#include "app/fit/fit_checks.hpp"
#include "criteria/leave_out.hpp"

namespace sysid {

/// Draws with weights that make them draws of that posterior; pareto_k says whether they do.
struct EarlierDraws {
  LaneArray declared;  // [parameters x draws]
  LeftOut weights;
};

/// Of all rows of the other experiments and, of this one, those before index `end`: the fit's modes are followed to the shorter
/// record, and `draws` from Student's t distributions there are weighted by the density; further rounds of as many, from where the
/// weighted ones are, while k is above 0.3 and the weights are worth less than half as many
/// equal ones, and there are `most` in all at most. Each draw counts against the mixture of all rounds.
/// Nothing above 40 parameters, and where no mode is left.                                 Cornuet, Marin, Mira and Robert 2012
std::optional<EarlierDraws> earlier_draws(FinishedFit& fit, int experiment, int end, int draws, int most);

}  // namespace sysid
