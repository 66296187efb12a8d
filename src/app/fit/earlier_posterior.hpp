// The posterior of the rows before one of them, where draws of the whole posterior are too far from it to be weighted.
#pragma once
#include <optional>

#include "app/fit/fit_checks.hpp"
#include "criteria/leave_out.hpp"

namespace sysid {

/// Steps of the walkers to each earlier posterior.
inline constexpr int walk_steps = 24;

/// Draws with weights that make them draws of that posterior; pareto_k says whether they do.
struct EarlierDraws {
  LaneArray declared;  // [parameters x draws]
  LeftOut weights;
};

/// Of all rows of the other experiments and, of this one, those before index `end`: the fit's modes are followed to the shorter
/// record, and `draws` from Student's t distributions there are weighted by the density. While k is above 0.3, draws of a posterior
/// nearby walk on to this one, and a mixture fitted to where they get gives a further round, up to `most` draws in all. Each draw
/// counts against the mixture of all rounds; rounds after that with the smallest k do not count. Nothing above 40 parameters, and
/// where no mode is left.                                                               Cornuet, Marin, Mira and Robert 2012
///
/// near [P x W]: draws on the sampler's coordinates of the posterior of more rows; then of this one. W = 0: one round.
std::optional<EarlierDraws> earlier_draws(FinishedFit& fit, int experiment, int end, int draws, int most, LaneArray& near);

}  // namespace sysid
