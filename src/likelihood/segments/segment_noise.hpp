// Noise of the channels estimated from the residuals of segments, the likelihood with it, and rows in its units.
#pragma once
#include <span>
#include <vector>

#include "likelihood/segments/segments.hpp"

namespace sysid {

/// S_c, the sum of squared residuals of each channel, SI.
std::vector<double> squares_of(SegmentSimulation const& simulation, std::vector<SegmentSlopes> const& slopes);

/// sqrt(S_c / (n_c (1 - used / N))), SI: n_c samples of the channel, N of all, of which `used` unknowns take their share. At least
/// the least noise of the channel. Where noise is not alike in all samples: of those whose relative noise is 1.
std::vector<double> noise_of(SegmentSimulation const& simulation, std::span<double const> squares, double used);

/// - sum_c n_c/2 log(2 pi s_c^2) + S_c / (2 s_c^2) + sum of log relative noise, s_c the noise with nothing used up: the normal log
/// likelihood at the optimum of its noise.
double log_likelihood_of(SegmentSimulation const& simulation, std::span<double const> squares);

/// `signal_of` (coefficient_prior.hpp) of the record with this noise: r is the variance of the motion over that of the noise,
/// its logarithm averaged over samples.
double signal_of(SegmentSimulation const& simulation, std::span<double const> noise_sd);

/// The rows of a segment, residuals and slopes, divided by the noise sd of their channels.
SegmentSlopes weighted(SegmentSimulation const& simulation, SegmentSlopes slopes, int segment, std::span<double const> noise_sd);
/// All segments.
std::vector<SegmentSlopes> weighted(SegmentSimulation const& simulation, std::vector<SegmentSlopes> slopes,
                                    std::span<double const> noise_sd);

}  // namespace sysid
