// Weighted draws of a posterior that is far from normal: what they are drawn from is fitted to walkers that have spread over it.
#pragma once
#include <functional>
#include <vector>

#include "core/numeric/random.hpp"
#include "core/system/ledger.hpp"
#include "search/objective.hpp"

namespace sysid::marginal {

/// Draws with their weights, and whether these can be believed.
struct WalkedDraws {
  LaneArray theta;                  // [P x N]
  std::vector<double> log_weights;  // [N] log of density over that of what they were drawn from
  std::vector<double> log_density;  // [N]
  LaneArray walked;                 // [P x n] where the walkers of the last round have been
  double effective = 0;             // number of equally weighted draws that they are worth
  bool confirmed = false;           // healthy weights, and as wide as where the walkers have been

  bool empty() const { return theta.width() == 0; }
};

/// Rounds, until the weights are confirmed or `most` densities are used up: `walkers` [P x W] walk, a mixture of normal and
/// Student's t distributions is fitted to where they have been, and draws of it are weighted by the density over the mixture of all
/// rounds. Weights of draws that have not reached a tail look healthy: only walkers, which go wherever the density is, find it. One
/// that has strayed to where healthy weights are a hundredth of their mean begins the next round at a weighted draw.
///
/// Empty where not even one round was possible.
WalkedDraws walked_draws(Objective const& objective, LaneArray walkers, std::uint64_t most, StreamKey key, Ledger& ledger,
                         std::function<bool()> const& stop);

/// `count` of the draws [P x N], each as often as its weight says: the one at which the share (w + 1/2)/count of all weight is
/// reached. [P x count]
LaneArray resampled(LaneArray const& draws, std::vector<double> const& weights, int count);

}  // namespace sysid::marginal
