// `sysid compare`: results of fits and predictions, read back and set side by side.
#pragma once
#include <filesystem>
#include <vector>

#include "report/comparison.hpp"

namespace sysid {

/// folders: of tasks, or of whole runs, whose fits and predictions are then all taken. Fits are compared by their evidence, a
/// density of the measured samples: UserError where they are not all of the same samples, in the same units, or where a folder
/// holds no result of a fit or a prediction. Each model counts once, however often it was fitted. Predictions of the same samples
/// come one after another. IoError where a folder is not there.
Comparison compare(std::vector<std::filesystem::path> const& folders);

}  // namespace sysid
