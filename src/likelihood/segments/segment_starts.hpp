// Start states of segments, fitted with the coefficients held fixed.
#pragma once
#include <functional>
#include <span>

#include "likelihood/segments/segments.hpp"

namespace sysid {

/// Start states alone, coefficients as they are, each segment for itself: its own damping, its own end. A segment that is
/// not finite from its start, nor from starts a little to the side, keeps it. noise_sd: per channel, SI. interrupted: asked each
/// round; the point is then as far as it got.
void fit_starts(SegmentSimulation const& simulation, ShootingPoint& point, std::span<double const> noise_sd,
                std::function<bool()> const& interrupted = {});

}  // namespace sysid
