// Cholesky by columns within the band.
#include "linear_algebra/band_matrix.hpp"

#include <algorithm>
#include <cmath>

namespace sysid::regression {

bool BandMatrix::factor() {
  BandMatrix& a = *this;
  int const n = size();
  for (int j = 0; j < n; ++j) {
    for (int k = std::max(0, j - band_); k < j; ++k) {
      double const factor = a(j, k);
      for (int i = j; i <= std::min(n - 1, k + band_); ++i) a(i, j) -= factor * a(i, k);
    }
    double const pivot = a(j, j);
    if (!(pivot > 0)) return false;
    double const root = std::sqrt(pivot);
    for (int i = j; i <= std::min(n - 1, j + band_); ++i) a(i, j) /= root;
  }
  return true;
}

void BandMatrix::solve_lower(Eigen::Ref<Eigen::MatrixXd> b) const {
  BandMatrix const& l = *this;
  for (int j = 0; j < size(); ++j) {
    b.row(j) /= l(j, j);
    for (int i = j + 1; i <= std::min(size() - 1, j + band_); ++i) b.row(i) -= l(i, j) * b.row(j);
  }
}

void BandMatrix::solve_upper(Eigen::Ref<Eigen::MatrixXd> b) const {
  BandMatrix const& l = *this;
  for (int j = size() - 1; j >= 0; --j) {
    for (int i = j + 1; i <= std::min(size() - 1, j + band_); ++i) b.row(j) -= l(i, j) * b.row(i);
    b.row(j) /= l(j, j);
  }
}

}  // namespace sysid::regression
