// The weak form: residuals integrated against test functions, derivatives moved onto them, their noise covariance known.
#pragma once
#include <memory>
#include <span>

#include "regression/column/columns.hpp"

namespace sysid::regression::weak {

std::span<SettingRow const> settings();
std::string refuse(Settings const& settings, int derivatives);

/// Row k of an equation is integral phi_k (known - sum_j w_j term_j) dt with phi_k the bump of TestFunction, of integral 1, around
/// a sample. Only measured samples enter a moved or potential piece (weak_pieces.hpp), so their noise passes linearly to first
/// order, and the covariance of the rows is known (Bortz, Messenger, Dukic 2023): weak_covariance.hpp. It is banded, since windows
/// overlap; whitening multiplies by the inverse of its Cholesky factor.
std::unique_ptr<Projection> project(Dictionary const& dictionary, std::span<Experiment const> experiments,
                                    Settings const& settings);

}  // namespace sysid::regression::weak
