// Whether a model is linear in its states and disturbances, so that a Kalman filter is exact.
#pragma once
#include <optional>

#include "model/model.hpp"

namespace sysid {

/// The first part of the equations, or of the noise of a channel, that is not: products of two states, or of a state and a
/// disturbance, are none. The sd of a channel may read neither.
std::optional<NodeId> find_nonlinear_in_states(Model const& model);

}  // namespace sysid
