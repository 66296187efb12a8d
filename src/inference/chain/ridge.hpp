// Curved ridges of a density, as a row of normal distributions.
#pragma once
#include <cstdint>
#include <vector>

#include "core/system/ledger.hpp"
#include "inference/chain/independence.hpp"
#include "result/mode.hpp"
#include "search/objective.hpp"

namespace sysid::metropolis {

/// Normal distributions along a ridge.
struct RidgeRow {
  std::vector<Independence::Component> components;  // at least one
  bool complete = false;                            // from end to end: else mass lies beyond it, which draws of it do not tell
};

/// Follows the ridge through a mode to both sides, in prior widths: a step along the tangent t, then Newton steps across it back to
/// the top, with the Gauss-Newton curvature H. Steps are as long as their ends stay within a standard deviation across the ridge.
/// At each place x the density is about
///
///   N(x, A - A t t'A / t'A t + u u' (0.7 step)^2),   A = H^-1, u = A t / t'A t,   of mass  p(x) (det A / t'A t)^(1/2) step
///
/// until that mass is e^-8 of the largest: only then is an end of the ridge reached. A side ends before where nothing can be
/// followed, and after 300 places. The components are what integration over a grid along the posterior's axes uses, bent with it.
///                                                                                          Rue, Martino and Chopin 2009, 3.1
RidgeRow along_ridge(Objective const& objective, Mode const& mode, Ledger& ledger);

/// The share of independent draws that draws of a mixture are worth, (sum w)^2 / (n sum w^2) of n = 512 with w = p/q; 0 where
/// none has a density.                                                                                               Owen 2013, 9.3
double worth_of_draws(Objective const& objective, Independence const& mixture, std::uint64_t seed, Ledger& ledger);

}  // namespace sysid::metropolis
