// Restoring forces of the springs and dampers of a model along an experiment, from trajectories of draws.
#pragma once
#include <span>
#include <vector>

#include "data/experiment.hpp"
#include "likelihood/trajectory.hpp"
#include "result/restoring_force.hpp"

namespace sysid {

/// Adds those of every link between the masses of a model (mechanics/coupling.hpp), a mass with the ground of its own included; a
/// model without masses has none. Of many masses twelve links are, and nothing where earlier experiments have left three: a fleet
/// of fifty has one spring. quantities, result: of trajectories along the experiment; parameters: those they were run with, SI
/// [parameters x draws].
void add_restoring_forces(Model const& model, std::span<TrajectoryQuantity const> quantities, Trajectory::Result const& result,
                          ConstLanes parameters, Experiment const& experiment, std::vector<RestoringForce>& forces);

}  // namespace sysid
