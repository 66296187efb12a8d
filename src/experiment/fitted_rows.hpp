// Whether a prediction is scored on rows that its fit used.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/experiments.hpp"
#include "result/finding.hpp"

namespace sysid {

/// The note `fitted_rows_predicted` where scored rows of a predicted experiment are rows of the same file that a fit used. folder:
/// that paths of data blocks begin at. fitted: the experiments of the fit. task: its name.
Findings find_fitted_rows(CheckedFile const& file, std::filesystem::path const& folder, ExperimentData const& predicted,
                          std::vector<ExperimentUse> const& fitted, std::string const& task);

}  // namespace sysid
