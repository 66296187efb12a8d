// Normal moves of one covariance for all centres.
#include <vector>

#include "core/numeric/elementary.hpp"
#include "core/numeric/normals.hpp"
#include "inference/abc/kernel.hpp"
#include "inference/abc/kernel_numerics.hpp"

namespace sysid::abc {
namespace {

/// One covariance for all centres: distances are Euclidean once both are multiplied by L^-1.
class Gaussian : public Kernel {
 public:
  Gaussian(ConstLanes at, std::span<double const> weight, double scale, Eigen::MatrixXd const& covariance)
      : at_(at),
        weight_(weight),
        factor_(scaled_factor(scale, covariance)),
        log_normaliser_(log_normaliser(factor_)),
        white_(whiten(at)) {}

  void perturb(std::span<int const> centres, std::span<Stream> streams, Lanes out) const override {
    draw_normals(streams, out);
    for (std::size_t w = 0; w < centres.size(); ++w) move_from(at_, centres[w], factor_, out, static_cast<int>(w));
  }

  void log_density(ConstLanes x, std::span<double> out) const override {
    LaneArray const places = whiten(x);
    std::vector<double> square(static_cast<std::size_t>(at_.width()));
    for (int w = 0; w < x.width(); ++w) {
      std::fill(square.begin(), square.end(), 0.0);
      for (int d = 0; d < at_.rows(); ++d) {
        double const place = places(d, w);
        double const* const row = white_.row(d).data();
        for (std::size_t j = 0; j < square.size(); ++j) square[j] += (row[j] - place) * (row[j] - place);
      }
      out[static_cast<std::size_t>(w)] = log_normaliser_ + elementary::log(weighted_exponentials(square, weight_));
    }
  }

 private:
  LaneArray whiten(ConstLanes x) const {
    LaneArray white(x.rows(), x.width());
    for (int d = 0; d < x.rows(); ++d)
      for (int w = 0; w < x.width(); ++w) {
        double value = x(d, w) - at_(d, 0);  // from among the centres: digits stay
        for (int e = 0; e < d; ++e) value -= factor_(d, e) * white(e, w);
        white(d, w) = value / factor_(d, d);
      }
    return white;
  }

  ConstLanes at_;
  std::span<double const> weight_;
  Eigen::MatrixXd factor_;
  double log_normaliser_;
  LaneArray white_;
};

}  // namespace

std::unique_ptr<Kernel> make_gaussian(Plan const& plan, ConstLanes at, std::span<double const> weight, Width const& width) {
  return std::make_unique<Gaussian>(at, weight, plan.scale, width.covariance);
}

std::unique_ptr<Kernel> make_component_gaussian(Plan const& plan, ConstLanes at, std::span<double const> weight,
                                                Width const& width) {
  return std::make_unique<Gaussian>(at, weight, plan.scale, width.covariance.diagonal().asDiagonal());
}

}  // namespace sysid::abc
