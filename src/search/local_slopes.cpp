// From lanes to matrices.
#include "search/local_slopes.hpp"

namespace sysid {

std::vector<LikelihoodSlope> local_slopes(Target const& target, ConstLanes theta, Eigen::VectorXd const& steps, Ledger& ledger) {
  int const dimension = target.dimension(), width = theta.width();
  LaneArray gradient(dimension, width), curvature(dimension * dimension, width);
  target.gauss_newton(theta, {steps.data(), static_cast<std::size_t>(dimension)}, gradient, curvature, ledger);
  std::vector<LikelihoodSlope> slopes;
  for (int k = 0; k < width; ++k) {
    LikelihoodSlope slope{Eigen::VectorXd(dimension), Eigen::MatrixXd(dimension, dimension)};
    for (int p = 0; p < dimension; ++p) {
      slope.gradient(p) = gradient(p, k);
      for (int q = 0; q < dimension; ++q) slope.curvature(p, q) = curvature(p * dimension + q, k);
    }
    slopes.push_back(std::move(slope));
  }
  return slopes;
}

}  // namespace sysid
