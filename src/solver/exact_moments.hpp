// How mean and covariance of linear equations under white noise pass over one step, without an error.
#pragma once
#include <span>
#include <vector>

#include "solver/stages.hpp"

namespace sysid {

/// Of x' = A x + b(t) + w, w white noise of intensity Q, over a step h: x <- F x + ..., P <- F P F' + V. Matrices [n x n], row by
/// row, expressions of parameters and the sampling step alone.
struct ExactMoments {
  std::vector<NodeId> states;      // the means after the step
  std::vector<NodeId> transition;  // F = exp(hA)
  std::vector<NodeId> integral;    // of exp(sA) over the step
  std::vector<NodeId> added;       // V = integral of exp(sA) Q exp(sA)' over the step
};

/// stages: of equations that find_nonlinear (solver/linear_structure.hpp) lets pass. intensity: Q, of parameters alone.
ExactMoments exact_moments(Stages const& stages, std::span<NodeId const> intensity);

}  // namespace sysid
