// The evidence by tempered sequential Monte Carlo: a population that goes from the prior to the posterior.
#pragma once
#include <cstdint>
#include <functional>

#include "core/system/ledger.hpp"
#include "likelihood/target.hpp"

namespace sysid::marginal {

struct SmcEstimate {
  double log_evidence = 0;
  double error = 0;      // one standard error, nats
  double effective = 0;  // number of ancestors that the last population is worth
  std::uint64_t simulations = 0;
  bool finished = false;  // else the simulations were used up on the way
};

/// Particles are drawn from the prior and weighted by L^(b' - b) from one power b of the likelihood to the next, chosen so that the
/// weights are worth half of the particles; the evidence is the product of the mean weights. After each weighting they are
/// resampled and moved: in turn by draws of a mixture that is fitted to them and by a random walk, each followed by Metropolis and
/// Hastings' decision.                                     Neal 2001; Del Moral, Doucet and Jasra 2006; Jasra, Stephens, Doucet and
/// Tsagaris 2011
///
/// The error follows from how many of the first particles have descendants (Lee and Whiteley 2018, eq. 5). It sees all modes that
/// particles of the prior find, and needs no draws and no modes.
SmcEstimate smc(Target const& target, int particles, std::uint64_t most_simulations, std::uint64_t seed, Ledger& ledger,
                std::function<bool()> const& stop);

}  // namespace sysid::marginal
