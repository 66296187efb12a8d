// Samples that a task counts twice, because two of its experiments have them in common.
#pragma once
#include <vector>

#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// The error `samples_repeated` for each pair of experiments whose measured samples of a channel are the same numbers at the same
/// times, wherever both have some: a likelihood counts them twice, and its sds come out too small. Silent for fewer than ten such
/// samples and for fewer than five different numbers: switches, counts and records at rest repeat by themselves.
Findings find_repeated_samples(CheckedFile const& file, std::vector<ExperimentData> const& data, Model const& model);

}  // namespace sysid
