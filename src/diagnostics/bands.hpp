// Trajectories of draws condensed to what reports show.
#pragma once
#include <span>

#include "data/experiment.hpp"
#include "diagnostics/scores.hpp"
#include "likelihood/trajectory.hpp"
#include "result/finding.hpp"

namespace sysid {

/// The rows and inputs of an experiment, without any quantity.
Prediction record_along(Experiment const& experiment, Model const& model);

/// Bands of every quantity along an experiment, with and without noise, beside the measured samples; declared units.
Prediction bands_along(std::span<TrajectoryQuantity const> quantities, Trajectory::Result const& result,
                       Experiment const& experiment, Model const& model);

/// Without what reads a parameter of the noise: particles of a selection have none. Says what went.
Findings leave_out_noise(Model const& model, Prediction& prediction);

/// One finding per quantity that has no value somewhere along some trajectories that did not fail: its band leaves them out.
/// failed: how many did, of what is measured and of other quantities (which in a selection are of one model alone). several: the
/// experiment is named.
Findings band_findings(Prediction const& prediction, int failed, int failed_elsewhere, bool several);

/// The streams of measurement noise for the predictions of experiment `experiment` of a task: its draws have indices from 0 on.
StreamKey prediction_noise(std::uint64_t seed, int experiment);

}  // namespace sysid
