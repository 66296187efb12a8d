// What the channels of an experiment measure of a mass.
#pragma once
#include <vector>

#include "data/experiment.hpp"
#include "mechanics/oscillators.hpp"

namespace sysid {

/// SI, [rows]; NaN where a sample is missing. Empty: no channel measures it.
struct MeasuredMotion {
  std::vector<double> displacement;  // of a channel whose location is the displacement, but for a constant
  std::vector<double> acceleration;  // of one whose location is the acceleration, but for what does not depend on the states
};

/// states: along which the model moves, [rows][states], SI; so many rows are looked at. Derivatives are added to the graph.
MeasuredMotion measured_motion(Model const& model, Graph& graph, Mass const& mass, Accelerations const& accelerations,
                               std::vector<std::vector<double>> const& states, Experiment const& experiment);

/// The samples of all inputs at a row.
std::vector<double> inputs_at(Experiment const& experiment, std::size_t row);

}  // namespace sysid
