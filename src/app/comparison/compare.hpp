// `sysid compare`: results of fits and predictions, read back and set side by side.
#pragma once
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "report/page/comparison.hpp"

namespace sysid {

/// As `prediction_rule` of an average over one-step predictions and free runs.
inline constexpr std::string_view mixed_kinds = "mixed";

/// What a task's model is called, of the task's name and the name that its results know.
using ModelNames = std::function<std::string(std::string const& task, std::string const& model)>;

/// folders: of tasks, or of whole runs, whose fits and predictions are then all taken. Fits are compared by their evidence, a
/// density of the measured samples: UserError where they are not all of the same samples, in the same units, or where a folder
/// holds no result of a fit or a prediction. Each model counts once, however often it was fitted. Predictions of the same samples
/// come one after another. IoError where a folder is not there. Without `model_of` models are called as their results know them.
Comparison compare(std::vector<std::filesystem::path> const& folders, ModelNames const& model_of = {});

}  // namespace sysid
