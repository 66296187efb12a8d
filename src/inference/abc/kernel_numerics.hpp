// What the normal kernels have in common.
#pragma once
#include <Eigen/Core>
#include <span>

#include "core/random.hpp"

namespace sysid::abc {

/// sum_j weight_j exp(-square_j / 2), in four interleaved partial sums, the same on every machine. Overwrites square.
double weighted_exponentials(std::span<double> square, std::span<double const> weight);

/// log of 1 / sqrt((2 pi)^D det(L L')).
double log_normaliser(Eigen::MatrixXd const& factor);

/// Adds L z, z standard normal, to out: [D].
void add_normals(Eigen::MatrixXd const& factor, Stream& stream, std::span<double> out);

}  // namespace sysid::abc
