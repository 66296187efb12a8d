// A tracked program along rows of a record: what it begins with, and what it records.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/text/diagnostic.hpp"
#include "tracking/tracker.hpp"

namespace sysid {

/// Means and covariances as the program has them.
std::vector<double> moments_of(TrackedProgram const& program, StatePrior const& states, TrackedPrior const& parameters);

/// What the program reads: intensities of the tracked parameters (empty: 0), where its moments stand, and what the noise variances
/// of the channels are multiplied by (empty: 1).
LaneArray parameters_of(TrackedProgram const& program, std::span<double const> intensities, std::span<double const> moments,
                        std::span<double const> factors = {});

/// Records of all rows of an experiment [rows x records]; false where they are not finite.
bool records_along(TrackedProgram const& program, SolverSettings const& solver, ExecutionOptions const& execution,
                   Experiment const& experiment, LaneArray const& parameters, LaneArray& records);

UserError diverged(Experiment const& experiment, std::int64_t row);

}  // namespace sysid
