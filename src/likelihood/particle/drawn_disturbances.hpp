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

/// White noise is a straight line on each of the `pieces` parts of a sampling interval, whose mean and slope are independent: its
/// first and second integrals over a part of length h, which are what a mass makes of it, have the variances q h and q h^3/3 and
/// the covariance q h^2/2 of white noise. What is faster than the parts is the only approximation: an Ornstein-Uhlenbeck
/// disturbance loses 5 % of its variance where its time is a third of a part, more where it is less. A solver steps over them
/// without an error of its own where its steps are fixed and `pieces` of them, or a multiple; others need `pieces` = 1. Noise of
/// discrete time and errors of inputs, which are held, are as declared. parameters: [parameters x 1], SI; NaN where the model does
/// not read them. Disturbance d uses the stream of step d of the key, starts that of step 2^20.
DrawnDisturbances draw_disturbances(Model model, ConstLanes parameters, Experiment experiment, StreamKey key, int pieces);

}  // namespace sysid
