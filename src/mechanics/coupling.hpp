// The springs, dampers and hystereses between the masses of a model.
#pragma once
#include <cstddef>
#include <optional>
#include <vector>

#include "mechanics/oscillators.hpp"

namespace sysid {

/// What acts between a mass and another one, or the ground.
struct Link {
  std::size_t mass;
  std::optional<std::size_t> other = {};
  std::optional<std::size_t> input = {};  // in whose unit its force is; nothing: per unit of mass
  double scale = 1;                       // force per acceleration of the mass

  /// A mass that is held by this link alone, with its scale. Their inertia and what pushes them is the force of the link; empty
  /// where other links hold them, too.
  struct Held {
    std::size_t mass;
    double scale;
  };
  std::vector<Held> held = {};
};

/// Of a mass without neighbours the link to the ground, whatever its force reads. Of coupled masses those whose accelerations are
/// sums over links, each of an elongation q_i - q_j and its speed, at all states along which the model moves ([rows][states], SI);
/// any other mass has no link of its own. Links point away from the ground.
///
/// Scales are 1/|da/dx| of the first mass with an input, 1 where none has one, carried from mass to mass by action and reaction:
///
///   m_i a_ij(d, v) = -m_j a_ji(-d, -v)
std::vector<Link> links_of(Accelerations const& accelerations, std::vector<std::vector<double>> const& states);

}  // namespace sysid
