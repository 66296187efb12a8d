// Forward selection: one term after the other by what it explains of what is left.
#pragma once
#include <span>

#include "regression/choice/selector.hpp"

namespace sysid::regression::forward {

std::span<SettingRow const> settings();

/// Orthogonal least squares (Chen, Billings, Luo 1989): terms are made orthogonal to those taken, and the next one is that with the
/// largest error reduction ratio, q_j its part that is orthogonal:
///
///   err_j = (q_j^T known)^2 / (q_j^T q_j  known^T known)
///
/// Taken are as many as the evidence (default_log_evidence, every size as probable) is largest with, or with `least_ratio` those
/// up to the first below it. A term that was taken early in place of several others may be of no use in the end: with the number
/// left to the evidence, terms are then removed as long as that raises it.
Choice choose(LinearProblem const& problem, Settings const& settings, SelectorContext const& context);

}  // namespace sysid::regression::forward
