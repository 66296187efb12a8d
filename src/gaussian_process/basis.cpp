#include "gaussian_process/basis.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/elementary.hpp"

namespace sysid::gaussian_process {

Basis::Basis(Eigen::VectorXd centre, Eigen::VectorXd half_widths, std::vector<int> const& counts)
    : centre_(std::move(centre)), half_widths_(std::move(half_widths)) {
  Eigen::Index size = 1;
  for (int const count : counts) size *= count;
  frequencies_.resize(size, static_cast<Eigen::Index>(counts.size()));
  for (Eigen::Index j = 0; j < size; ++j) {
    Eigen::Index rest = j;
    for (Eigen::Index d = frequencies_.cols(); d-- > 0;) {
      int const count = counts[static_cast<std::size_t>(d)];
      frequencies_(j, d) = std::numbers::pi * static_cast<double>(rest % count + 1) / (2 * half_widths_[d]);
      rest /= count;
    }
  }
}

Eigen::MatrixXd Basis::functions(Eigen::MatrixXd const& inputs) const {
  Eigen::MatrixXd result(inputs.rows(), frequencies_.rows());
  double const volume = half_widths_.prod();
  result.setConstant(1 / std::sqrt(volume));
  Eigen::VectorXd angle(inputs.rows());
  for (Eigen::Index j = 0; j < result.cols(); ++j)
    for (Eigen::Index d = 0; d < inputs.cols(); ++d) {
      angle = frequencies_(j, d) * (inputs.col(d).array() - centre_[d] + half_widths_[d]);
      elementary::sin_lanes(angle.data(), angle.data(), static_cast<int>(angle.size()));
      result.col(j).array() *= angle.array();
    }
  return result;
}

bool has_spectral_density(Covariance const& covariance) {
  std::vector<Covariance::Term> const& terms = covariance.terms();
  return covariance.is_sum() && std::all_of(terms.begin(), terms.end(), [&](Covariance::Term const& term) {
           return term.row->spectral_density != nullptr && term.columns == terms.front().columns;
         });
}

Eigen::VectorXd spectral_weights(Covariance const& covariance, Numbers parameters, Basis const& basis) {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(basis.size());
  std::vector<double> frequencies(static_cast<std::size_t>(basis.frequencies().cols()));
  for (int j = 0; j < basis.size(); ++j) {
    for (std::size_t d = 0; d < frequencies.size(); ++d) frequencies[d] = basis.frequencies()(j, static_cast<Eigen::Index>(d));
    for (Covariance::Term const& term : covariance.terms())
      result[j] += term.row->spectral_density(
          parameters.subspan(static_cast<std::size_t>(term.first_parameter), static_cast<std::size_t>(term.parameter_count)),
          frequencies);
  }
  return result;
}

}  // namespace sysid::gaussian_process
