// What draws near the modes of a posterior, weighted by its density, tell of its mass and widths: whether the normal distributions
// at its modes are the posterior.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "likelihood/target.hpp"
#include "result/mode.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

/// Modes of the density on the sampler's coordinates that those of `objective_kind` lead to, each once; of any weight.
std::vector<Mode> sampled_modes(Target const& target, ObjectiveKind objective_kind, std::vector<Mode> const& modes,
                                std::uint64_t seed, Ledger& ledger, std::function<bool()> const& stop);

struct WeightedDraws {
  double log_evidence = 0, error = 0;  // log of the mean weight, and its standard error
  double effective = 0;                // number of equally weighted draws that they are worth
  int draws = 0;
  std::vector<double> mean, sd;  // [P] of the posterior, declared units
  Eigen::VectorXd highest;       // [P] where the density of the posterior is highest, sampler's coordinates

  /// As many as a width to a tenth takes.
  bool tell() const { return effective >= 50; }
  /// Whether the weights are to be believed: as many effective draws as a width to a tenth takes, and a tail whose means exist.
  bool confirmed = false;
  bool walked = false;  // walkers have looked for tails that the draws do not reach
};

/// By adaptive importance sampling on the sampler's coordinates: in pairs mirrored at the mode, half of them from the normal
/// distributions of the Laplace approximation, half from Student's t with four degrees of freedom; further rounds, from what the
/// weighted draws before have as mean and covariance, only where the weights differ much. A draw counts against the mixture of all
/// rounds.                                                                Owen 2013, ch. 9; Cornuet, Marin, Mira and Robert 2012
///
/// 300 densities where the posterior is nearly normal, six times as many at most.
///
/// stated: whose sds are in question; null: nobody's. Where the draws are not confirmed, or give a width that neither this nor the
/// only mode has, draws of what walkers from there have reached stand in their place (`walked_draws`); where even those are not
/// confirmed, mean and sd are those of the walkers. That takes 10,000 to 60,000 densities more: above some thousand rows fewer, or
/// nothing of it is done.
///
/// Nothing (no draws) above 40 parameters, without modes, and of a target whose densities are dear (`is_expensive`).
WeightedDraws weighted_draws(Target const& target, std::vector<Mode> const& modes, std::uint64_t seed, Ledger& ledger,
                             std::function<bool()> const& stop, Mode const* stated = nullptr);

}  // namespace sysid
