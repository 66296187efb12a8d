// What an estimate of an evidence is made of: draws of a mixture with both log densities there, and draws of the posterior.
#pragma once
#include <functional>
#include <vector>

#include "core/system/ledger.hpp"
#include "inference/evidence/mixture.hpp"
#include "result/draws.hpp"
#include "search/objective.hpp"

namespace sysid::marginal {

/// Draws of a mixture.
struct MixtureSample {
  std::vector<double> log_density;         // [N] of prior times likelihood
  std::vector<double> log_mixture;         // [N]
  std::vector<std::vector<double>> terms;  // [2 K][N] log densities of the parts of the mixture, without shares

  int size() const { return static_cast<int>(log_density.size()); }
};

/// Adds as many draws, those after the ones that are there, in one batch of simulations.
void add_draws(Objective const& objective, Mixture const& mixture, int count, std::uint64_t seed, MixtureSample& sample,
               Ledger& ledger, std::function<bool()> const& stop);

/// Draws of a posterior on the sampler's coordinates.
struct PosteriorSample {
  LaneArray theta;                            // [P x n]
  std::vector<std::vector<double>> of_chain;  // [chains][draws]: log density of prior times likelihood; all equally long
  std::vector<double> log_mixture;            // [n] of a mixture, once it has been looked at; chain after chain
  LaneArray terms;                            // [2 K x n] of it

  int size() const { return theta.width(); }
};

/// The first half of each chain, or the second; fewer than twice `most` draws, evenly spread. Draws of which nothing finite is known
/// are left out with those that other chains have at their place. theta of the first half: those of all chains at one place are
/// neighbours; of the second: chain after chain.
PosteriorSample half_of(Target const& target, Draws const& draws, bool second, int most);

/// Fills in the densities of a mixture.
void look_at(Mixture const& mixture, PosteriorSample& sample);

}  // namespace sysid::marginal
