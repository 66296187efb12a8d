// A model with random states along one draw of what is random: its disturbances as inputs, its starts as numbers. What simulations
// of such models run.
#pragma once
#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"
#include "data/experiment.hpp"
#include "model/model.hpp"

namespace sysid {

struct DrawnDisturbances {
  Model model;            // without random states; behind its inputs come those that were disturbances
  Experiment experiment;  // with these inputs
};

/// White noise is held from sample to sample: on an interval of length h with a variance of intensity/h, so that it has the
/// intensity for whatever is slow against the sampling. That is the only approximation; noise of discrete time and errors of inputs
/// are as declared. parameters: [parameters x 1], SI; NaN where the model does not read them. Disturbance d uses the stream of step
/// d of the key, starts that of step 2^20.
DrawnDisturbances draw_disturbances(Model model, ConstLanes parameters, Experiment experiment, StreamKey key);

}  // namespace sysid
