// Densities over all centres at once: the quadratic forms row by row, the exponentials in lanes, sums in the centres' order.
#include "inference/abc/kernel.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/elementary.hpp"

namespace sysid::abc {
namespace {

/// sum_j weight_j exp(-square_j / 2), in four interleaved partial sums, the same on every machine. Overwrites square.
double weighted_exponentials(std::span<double> square, std::span<double const> weight) {
  for (double& value : square) value *= -0.5;
  elementary::exp_lanes(square.data(), square.data(), static_cast<int>(square.size()));
  double part[4] = {0, 0, 0, 0};
  for (std::size_t j = 0; j < square.size(); ++j) part[j % 4] += weight[j] * square[j];
  return (part[0] + part[1]) + (part[2] + part[3]);
}

/// log of 1 / sqrt((2 pi)^D det(L L')).
double log_normaliser(Eigen::MatrixXd const& factor) {
  double log = -0.5 * static_cast<double>(factor.rows()) * elementary::log(2 * std::numbers::pi);
  for (Eigen::Index d = 0; d < factor.rows(); ++d) log -= elementary::log(factor(d, d));
  return log;
}

void add_normals(Eigen::MatrixXd const& factor, Stream& stream, std::span<double> out) {
  Eigen::VectorXd normal(factor.rows());
  for (double& value : normal) value = stream.normal();
  for (Eigen::Index d = 0; d < factor.rows(); ++d)
    for (Eigen::Index e = 0; e <= d; ++e) out[static_cast<std::size_t>(d)] += factor(d, e) * normal[e];
}

/// One covariance for all centres: distances are Euclidean once both are multiplied by L^-1.
class Gaussian : public Kernel {
 public:
  Gaussian(ConstLanes at, std::span<double const> weight, Eigen::MatrixXd const& covariance)
      : at_(at),
        weight_(weight),
        factor_(covariance.llt().matrixL()),
        log_normaliser_(log_normaliser(factor_)),
        white_(whiten(at)) {}

  void perturb(int centre, Stream& stream, std::span<double> out) const override {
    for (int d = 0; d < at_.rows(); ++d) out[static_cast<std::size_t>(d)] = at_(d, centre);
    add_normals(factor_, stream, out);
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

class Uniform : public Kernel {
 public:
  Uniform(ConstLanes at, std::span<double const> weight, Eigen::VectorXd const& widths)
      : at_(at), weight_(weight), widths_(widths) {
    for (double const width : widths_) log_density_ -= elementary::log(width);
  }

  void perturb(int centre, Stream& stream, std::span<double> out) const override {
    for (int d = 0; d < at_.rows(); ++d) out[static_cast<std::size_t>(d)] = at_(d, centre) + widths_[d] * (stream.uniform() - 0.5);
  }

  void log_density(ConstLanes x, std::span<double> out) const override {
    std::vector<double> inside(static_cast<std::size_t>(at_.width()));
    for (int w = 0; w < x.width(); ++w) {
      std::copy(weight_.begin(), weight_.end(), inside.begin());
      for (int d = 0; d < at_.rows(); ++d) {
        double const place = x(d, w), half = 0.5 * widths_[d];
        double const* const row = at_.row(d).data();
        for (std::size_t j = 0; j < inside.size(); ++j) inside[j] = std::abs(row[j] - place) <= half ? inside[j] : 0;
      }
      out[static_cast<std::size_t>(w)] = log_density_ + elementary::log(std::accumulate(inside.begin(), inside.end(), 0.0));
    }
  }

 private:
  ConstLanes at_;
  std::span<double const> weight_;
  Eigen::VectorXd widths_;
  double log_density_ = 0;  // in the box
};

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
      Eigen::LLT<Eigen::MatrixXd> const factorised(covariance);
      factors_.push_back(factorised.info() == Eigen::Success ? Eigen::MatrixXd(factorised.matrixL())
                                                             : Eigen::MatrixXd(width.covariance.llt().matrixL()));
      log_normalisers_.push_back(log_normaliser(factors_.back()));
    }
    log_scale_ = *std::max_element(log_normalisers_.begin(), log_normalisers_.end());
    for (std::size_t j = 0; j < log_normalisers_.size(); ++j)
      scaled_.push_back(weight[j] * elementary::exp(log_normalisers_[j] - log_scale_));
  }

  void perturb(int centre, Stream& stream, std::span<double> out) const override {
    for (int d = 0; d < at_.rows(); ++d) out[static_cast<std::size_t>(d)] = at_(d, centre);
    add_normals(factors_[static_cast<std::size_t>(centre)], stream, out);
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

Width width_of(ConstLanes at, std::span<double const> weight, Width const& last) {
  int const dimension = at.rows(), count = at.width();
  if (count < dimension + 2) return last;
  Width width{Eigen::MatrixXd::Zero(dimension, dimension), Eigen::VectorXd::Zero(dimension)};
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(dimension);
  for (int d = 0; d < dimension; ++d) {
    auto const row = at.row(d);
    for (std::size_t j = 0; j < row.size(); ++j) mean[d] += weight[j] * row[j];
    auto const [low, high] = std::minmax_element(row.begin(), row.end());
    width.range[d] = *high - *low;
  }
  for (int d = 0; d < dimension; ++d)
    for (int e = 0; e <= d; ++e) {
      double sum = 0;
      for (int j = 0; j < count; ++j) sum += weight[static_cast<std::size_t>(j)] * (at(d, j) - mean[d]) * (at(e, j) - mean[e]);
      width.covariance(d, e) = width.covariance(e, d) = sum;
    }
  bool const wide = dimension == 0 || width.range.minCoeff() > 0;
  return wide && width.covariance.llt().info() == Eigen::Success ? width : last;
}

std::unique_ptr<Kernel> make_kernel(Plan const& plan, ConstLanes at, std::span<double const> weight, Width const& width) {
  switch (plan.kernel) {
    case KernelKind::gaussian:
      return std::make_unique<Gaussian>(at, weight, plan.scale * width.covariance);
    case KernelKind::component_gaussian:
      return std::make_unique<Gaussian>(at, weight, plan.scale * Eigen::MatrixXd(width.covariance.diagonal().asDiagonal()));
    case KernelKind::uniform:
      return std::make_unique<Uniform>(at, weight, plan.scale * width.range);
    case KernelKind::nearest_neighbours:
      return std::make_unique<NearestNeighbours>(at, weight, width, plan.neighbours, plan.scale);
  }
  return nullptr;
}

}  // namespace sysid::abc
