// Samples that a task counts twice: two experiments have them in common, or rows of one were pasted twice.
#pragma once
#include <vector>

#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// The error `samples_repeated` for each pair of experiments whose measured samples of a channel are the same numbers at the same
/// times, wherever both have some: a likelihood counts them twice, and its sds come out too small. Silent for fewer than ten such
/// samples and for fewer than five different numbers: switches, counts and records at rest repeat by themselves.
/// Also for each part of an experiment that repeats an earlier one in all columns that the model reads, as rows pasted twice do: of
/// independent rows ten or more with five different numbers; of a model with dynamics, where the rows have no times of their own,
/// twenty or more just behind their originals, with different numbers in most of them. Never of parts that overlap, or that go on
/// to the last row of a model with dynamics: a periodic record without noise repeats itself.
Findings find_repeated_samples(CheckedFile const& file, std::vector<ExperimentData> const& data, Model const& model);

}  // namespace sysid
