// What the normal kernels have in common.
#pragma once
#include <Eigen/Core>
#include <span>

#include "core/numeric/lanes.hpp"

namespace sysid::abc {

/// sum_j weight_j exp(-square_j / 2), in four interleaved partial sums, the same on every machine. Overwrites square.
double weighted_exponentials(std::span<double> square, std::span<double const> weight);

/// L of L L' = scale * covariance. Where rounding or the range of numbers leaves that not positive definite, sqrt(scale) times the
/// factor of the covariance, or of its diagonal.
Eigen::MatrixXd scaled_factor(double scale, Eigen::MatrixXd const& covariance);

/// log of 1 / sqrt((2 pi)^D det(L L')).
double log_normaliser(Eigen::MatrixXd const& factor);

/// Makes centre + L z of z, which is column `lane` of out [D x W]; the centre a column of at [D x n].
void move_from(ConstLanes at, int centre, Eigen::MatrixXd const& factor, Lanes out, int lane);

}  // namespace sysid::abc
