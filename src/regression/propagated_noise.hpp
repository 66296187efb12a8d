// How large a residual the noise of the channels makes where a form of derivatives knows no covariance.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "regression/column/columns.hpp"

namespace sysid::regression {

/// Columns of every equation with the channels moved by a tenth of their noise, one draw: what they differ by from those of
/// `projection`, times ten, is the noise of the columns to first order. An equation with a fatal concern has empty ones.
std::vector<Columns> noise_of_columns(Dictionary const& dictionary, std::span<Experiment const> experiments, Form const& form,
                                      Settings const& settings, Projection const& projection, std::uint64_t seed);

}  // namespace sysid::regression
