// A record that begins in motion, and random states that begin at known values.
#pragma once
#include <cstddef>
#include <optional>

#include "diagnostics/residuals/channel_residuals.hpp"
#include "result/finding.hpp"

namespace sysid {

/// Samples at the beginning that a wrong start disturbs: until the filter has corrected the states and their rates.
inline constexpr std::size_t samples_of_start = 5;

/// How many of its predicted sds the first innovation of a channel lies off, of a filter whose states begin at known values: where
/// that is too far for chance (4.5; one in 150,000 records). The first scored sample alone is looked at, and only among the first
/// ones of the record.
std::optional<double> start_far_off(ChannelResiduals const& of);

/// `initial_far_off`, a warning, with the priors of the initial values that the states of the channel lack.
Finding initial_of_states(ChannelResiduals const& of, double sds);

}  // namespace sysid
