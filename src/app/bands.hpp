// Trajectories of draws condensed to what reports show.
#pragma once
#include "data/experiment.hpp"
#include "likelihood/trajectory.hpp"
#include "report/prediction.hpp"

namespace sysid {

/// Bands of every quantity along an experiment, with and without noise, beside the measured samples; declared units.
Prediction bands_along(Trajectory const& trajectory, Trajectory::Result const& result, Experiment const& experiment,
                       Model const& model);

/// The streams of measurement noise for the predictions of experiment `experiment` of a task: its draws have indices from 0 on.
StreamKey prediction_noise(std::uint64_t seed, int experiment);

}  // namespace sysid
