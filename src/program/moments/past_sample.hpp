// The states that SincePastSample is made of.
#pragma once
#include <vector>

#include "program/moments/moments.hpp"

namespace sysid {

/// Moments that are written as far as their means and covariances.
struct MomentsSoFar {
  SimulationSource& source;
  MomentPassage& passage;
  std::vector<MomentRow> const& rules;     // of each state: its next value by a map, else its derivative
  Symmetric const& covariance;             // expressions, or constants zero
  std::vector<NodeId> intensities;         // of the noises
  std::vector<std::vector<NodeId>> gains;  // [noises][n] what each gives to a state: per time; of a map, over its step
  NodeId length;                           // of the step, where a method's step makes the map
};

/// Adds them to the source, behind all others.
SincePastSample with_past_sample(MomentsSoFar const& moments);

}  // namespace sysid
