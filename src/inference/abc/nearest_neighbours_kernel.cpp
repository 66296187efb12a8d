// Normal moves of a covariance of its own for each centre.
#include <algorithm>
#include <numeric>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/normals.hpp"
#include "inference/abc/kernel.hpp"
#include "inference/abc/kernel_numerics.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid::abc {
namespace {

/// Each centre has a covariance of its own: that of its neighbours about it.
class NearestNeighbours : public Kernel {
 public:
  NearestNeighbours(ConstLanes at, std::span<double const> weight, Width const& width, int neighbours, double scale)
      : at_(at), weight_(weight) {
    Eigen::VectorXd const sd = width.covariance.diagonal().cwiseSqrt();
    std::vector<int> order(static_cast<std::size_t>(at.width()));
    std::vector<double> far(order.size());
    int const count = std::min(neighbours, at.width() - 1);
    for (int j = 0; j < at.width(); ++j) {
      for (int i = 0; i < at.width(); ++i) {
        double sum = 0;
        for (int d = 0; d < at.rows(); ++d) sum += (at(d, i) - at(d, j)) * (at(d, i) - at(d, j)) / (sd[d] * sd[d]);
        far[static_cast<std::size_t>(i)] = sum;
      }
      std::iota(order.begin(), order.end(), 0);
      std::partial_sort(order.begin(), order.begin() + count + 1, order.end(), [&](int a, int b) {
        double const fa = far[static_cast<std::size_t>(a)], fb = far[static_cast<std::size_t>(b)];
        return fa < fb || (fa == fb && a < b);
      });
      Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(at.rows(), at.rows());
      double total = 0;
      for (int k = 0; k <= count; ++k) {
        int const i = order[static_cast<std::size_t>(k)];
        Eigen::VectorXd difference(at.rows());
        for (int d = 0; d < at.rows(); ++d) difference[d] = at(d, i) - at(d, j);
        covariance += weight[static_cast<std::size_t>(i)] * difference * difference.transpose();
        total += weight[static_cast<std::size_t>(i)];
      }
      // Few neighbours span no volume.
      covariance =
          scale * (count < at.rows() + 1 ? width.covariance : Eigen::MatrixXd(covariance / total + 1e-6 * width.covariance));
      auto factor = cholesky(covariance);
      factors_.push_back(factor ? std::move(*factor) : scaled_factor(scale, width.covariance));
      log_normalisers_.push_back(log_normaliser(factors_.back()));
    }
    log_scale_ = *std::max_element(log_normalisers_.begin(), log_normalisers_.end());
    for (std::size_t j = 0; j < log_normalisers_.size(); ++j)
      scaled_.push_back(weight[j] * elementary::exp(log_normalisers_[j] - log_scale_));
  }

  void perturb(std::span<int const> centres, std::span<Stream> streams, Lanes out) const override {
    draw_normals(streams, out);
    for (std::size_t w = 0; w < centres.size(); ++w)
      move_from(at_, centres[w], factors_[static_cast<std::size_t>(centres[w])], out, static_cast<int>(w));
  }

  void log_density(ConstLanes x, std::span<double> out) const override {
    std::vector<double> square(scaled_.size());
    Eigen::VectorXd difference(at_.rows());
    for (int w = 0; w < x.width(); ++w) {
      for (std::size_t j = 0; j < square.size(); ++j) {
        Eigen::MatrixXd const& factor = factors_[j];
        double sum = 0;
        for (int d = 0; d < at_.rows(); ++d) {
          double value = x(d, w) - at_(d, static_cast<int>(j));
          for (int e = 0; e < d; ++e) value -= factor(d, e) * difference[e];
          difference[d] = value / factor(d, d);
          sum += difference[d] * difference[d];
        }
        square[j] = sum;
      }
      out[static_cast<std::size_t>(w)] = log_scale_ + elementary::log(weighted_exponentials(square, scaled_));
    }
  }

 private:
  ConstLanes at_;
  std::span<double const> weight_;
  std::vector<Eigen::MatrixXd> factors_;
  std::vector<double> log_normalisers_, scaled_;  // weights times normalisers, over exp(log_scale_)
  double log_scale_ = 0;
};

}  // namespace

std::unique_ptr<Kernel> make_nearest_neighbours(Plan const& plan, ConstLanes at, std::span<double const> weight,
                                                Width const& width) {
  return std::make_unique<NearestNeighbours>(at, weight, width, plan.neighbours, plan.scale);
}

}  // namespace sysid::abc
