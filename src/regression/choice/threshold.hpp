// Sequential thresholding on what a term contributes to the variance.
#pragma once
#include <span>

#include "regression/choice/selector.hpp"

namespace sysid::regression::threshold {

std::span<SettingRow const> settings();

/// Drops the term whose loss raises the residual least, refits, and goes on until the least contribution is at least `share`:
///
///   contribution_j = sqrt((S_without_j - S) / |known|^2)
///
/// with S the residual sum of squares. The size of a coefficient says nothing (units span ten orders), and the size of w_j A_j says
/// little where terms cancel each other; what the variance loses with a term is what the term contributes. Supports of up to 16
/// terms are improved by exchanges on the way (triangle.hpp).
Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context);

}  // namespace sysid::regression::threshold
