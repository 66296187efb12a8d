// Numbers in a record that mark missing measurements.
#pragma once
#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// A warning `looks_missing` for each number that a column holds in the rows that are simulated, written with three nines or more
/// and nothing else (-999, 9999, 99.99) or at the end of a 16-bit range, that lies far from all others: ten times as far from
/// their middle as they reach. Of channels only rows that are scored, or that a model in discrete time may go on from. Numbers and
/// rows are those of the file.
Findings find_placeholders(CheckedFile const& file, ExperimentData const& data, Model const& model);

}  // namespace sysid
