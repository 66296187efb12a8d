// The moves of chains over models and their parameters: jumps, and walks within a model.
#pragma once
#include <span>
#include <vector>

#include "core/numeric/random.hpp"
#include "core/system/ledger.hpp"
#include "inference/backend/selector.hpp"
#include "inference/evidence/mixture.hpp"

namespace sysid::jump {

/// A candidate with its proposals.
struct Model {
  LikelihoodCandidate const* candidate;
  marginal::Mixture mixture;  // empty of a model without parameters
  double bias = 0;            // log of the factor by which its visits are made rarer
  double scale = 1;           // of its walks
};

/// A model and parameters of it.
struct Place {
  int model = 0;
  std::vector<double> theta;  // [D], the sampler's coordinates
  double log_density = 0;     // of the model's prior probability, prior and likelihood there; -infinity where one has none
  double log_proposal = 0;    // of the model's mixture
};

/// Fills in the densities of places, those of one model in one batch. Throws Interrupted.
void evaluate(std::span<Model const> models, std::span<Place* const> places, Ledger& ledger);

/// Where jumps go to: one of the models alike, parameters from its mixture. Each depends on its key alone.
Place propose(std::span<Model const> models, StreamKey key);

/// log of the ratio of a jump, which does not depend on how the parameters of two models correspond: (m, theta) has the density
///
///   pi(m) exp(-bias_m) p(theta | m) L(theta | m)      on the sampler's coordinates, Jacobian in p
///
/// and is proposed with q(m, theta) = q_m(theta) / M, wherever the chain is; so the ratio is w(m', theta') / w(m, theta) with
/// w = density / q (Green 1995 with the identity between the numbers drawn and the parameters, whose Jacobian is 1).
double log_weight(std::span<Model const> models, Place const& place);

/// min(1, ratio) of going from one place to another by a jump.
double jump_acceptance(std::span<Model const> models, Place const& from, Place const& to);

/// Where a walk goes to: a step of the shape of any of the mixture's components, one in ten a tenth as long.
Place walk(std::span<Model const> models, Place const& from, StreamKey key);
/// min(1, ratio) of densities within a model.
double walk_acceptance(Place const& from, Place const& to);

}  // namespace sysid::jump
