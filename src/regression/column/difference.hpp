// Difference equations: rows are samples, terms read samples before.
#pragma once
#include <memory>
#include <span>

#include "regression/column/columns.hpp"

namespace sysid::regression::difference {

std::span<SettingRow const> settings();

/// y_i = sum_j w_j term_j + v_i, with v a moving average of independent errors e. Given its coefficients c, the rows divided by C
/// have independent errors, to be told by least squares; what a change of c does to them is projected out, so that the sds of w
/// count with c being unknown:
///
///   e(w + dw, c + dc) ~ e - (terms/C) dw - (e_i-k/C) dc         one Gauss-Newton step for w and c    Ljung 1999, sec. 10.2
///
/// Rows are those where all samples that the equation reads are there, and its target is scored.
std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments,
                                    Settings const& settings);

}  // namespace sysid::regression::difference
