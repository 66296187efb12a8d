// Rows of one experiment that stand in it twice.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// The error `samples_repeated` for each part of the experiment that repeats an earlier one in all columns that the model reads, as
/// rows pasted twice do: of independent rows ten or more with five different numbers; of a model with dynamics, where the rows have
/// no times of their own, twenty or more just behind their originals, with different numbers in most of them. Never of parts that
/// overlap, or that go on to the last row of a model with dynamics: a periodic record without noise repeats itself.
Findings find_pasted_rows(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
