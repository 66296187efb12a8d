// One component of the mixtures from which weighted draws come: a normal distribution and a Student's t of one place and shape.
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/numeric/random.hpp"

namespace sysid {

/// N(centre, S) and t_4(centre, S), S = root root'. Of a covariance that is not positive definite only the diagonal is used.
struct Component {
  static constexpr double freedom = 4;  // of Student's t

  Eigen::VectorXd centre;          // [P]
  Eigen::MatrixXd root;            // [P x P], lower
  double log_volume;               // log |det root|
  double log_normal, log_student;  // at the centre, without the volume

  Component(Eigen::VectorXd centre, Eigen::MatrixXd const& covariance);

  /// Normalised, all constants kept.
  struct LogDensity {
    double normal, student;
  };
  LogDensity log_density(Eigen::VectorXd const& u) const;
  /// The same of points at squared distances |root^-1 (u - centre)|^2. All [W].
  void log_densities(std::span<double const> squares, std::span<double> normal, std::span<double> student) const;
  /// root^-1 (u - centre) of the columns of theta [P x W].
  LaneArray whitened(ConstLanes theta) const;
  /// A draw minus the centre.
  Eigen::VectorXd move(Stream& stream, bool student) const;
};

/// Sum of squares of each column.
std::vector<double> squared_lengths(LaneArray const& z);

}  // namespace sysid
