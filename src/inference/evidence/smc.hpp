// The evidence by tempered sequential Monte Carlo: a population that goes from the prior to the posterior.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "core/system/ledger.hpp"
#include "likelihood/target.hpp"
#include "result/mode.hpp"

namespace sysid::marginal {

struct SmcEstimate {
  double log_evidence = 0;
  double error = 0;      // one standard error, nats
  double effective = 0;  // number of ancestors that the last population is worth
  std::uint64_t simulations = 0;
  bool unmoved = false;   // after some weighting there was nothing to propose by, and copies stayed copies
  bool finished = false;  // else the simulations were used up on the way
};

/// Particles are drawn from the prior and weighted by L^(b' - b) from one power b of the likelihood to the next, chosen so that the
/// weights are worth half of the particles; the evidence is the product of the mean weights. After each weighting they are
/// resampled and moved, until the ranks of each coordinate and of the likelihood are correlated by less than 0.15 with those
/// before: in turn by draws of a mixture and by a random walk of the shape of the component that a particle belongs to, each
/// followed by Metropolis and Hastings' decision.                     Neal 2001; Del Moral, Doucet and Jasra 2006; Jasra, Stephens,
/// Doucet and Tsagaris 2011
///
/// The mixture is fitted to the particles but for a fifth, which are normal and Student's t distributions at the modes, as wide as
/// the power leaves them. Where priors are much wider than the posterior and the size of the noise is estimated, a small power
/// holds nearly all particles at large noise; the mass then moves to small noise over a range of powers in which no particle is
/// there yet, and no walk from the others is as fast as the powers.
///
/// modes: in the sampler's coordinates; empty: local searches from the likeliest 16 of the first particles find them. They propose,
/// the target decides: a mode that is missing costs moves.
///
/// The error follows from how many of the first particles have descendants (Lee and Whiteley 2018, eq. 5). It sees all modes that
/// particles of the prior find.
SmcEstimate smc(Target const& target, int particles, std::vector<Mode> const& modes, std::uint64_t most_simulations,
                std::uint64_t seed, Ledger& ledger, std::function<bool()> const& stop);

}  // namespace sysid::marginal
