// Generated input records for `simulate`: reproducible from (seed, input) alone.
#pragma once
#include <vector>

#include "check/checked/checked.hpp"
#include "core/numeric/random.hpp"

namespace sysid {

/// [samples] values, SI, at times i * step.
///   gaussian   independent N(mean, sd^2) per sample
///   sine       mean + amplitude sin(2 pi frequency t + phase)
///   multisine  equal amplitudes, random phases, on the harmonics of the record inside [lowest, highest], scaled to the population
///   sd constant   value
/// The checker has refused a multisine without a harmonic in its band, and whatever reaches half the sampling rate.
std::vector<double> generate(InputGenerator const& generator, int samples, double step, StreamKey key);

}  // namespace sysid
