// Numbers in a record that stand for no measurement.
#pragma once
#include "data/experiment.hpp"
#include "inference/finding.hpp"
#include "model/model.hpp"

namespace sysid {

/// A warning `looks_missing` for each input and channel in which one number, written with nines only (-999, 9999, 99.99) or the end
/// of a 16-bit range, lies far from all others: ten times as far from their middle as they reach. Rows are those of the file.
Findings find_placeholders(Experiment const& experiment, Model const& model);

}  // namespace sysid
