// Matrices of a few states, sample after sample; the inverse by Cholesky's factor with pivots.
#include "likelihood/smoothing/backward_pass.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

namespace sysid {
namespace {

/// Solves with a covariance that may be singular: variances are scaled to 1, and a direction of which no more is left than rounding
/// and the solver may have left of one is none. Of ten states behind one noise, just after a known start, the smoothed means are
/// then wrong by 1e-5 of the sd; with 1e-13 sds are by 3e-3, since what ten substeps leave of the farthest states is no covariance.
class Covariance {
 public:
  explicit Covariance(Eigen::Index size) : scale_(size), factor_(size, size), order_(static_cast<std::size_t>(size)) {}

  void factor(Eigen::MatrixXd const& of) {
    constexpr double least = 1e-10;
    Eigen::Index const size = of.rows();
    for (Eigen::Index i = 0; i < size; ++i) scale_(i) = of(i, i) > 0 ? 1 / std::sqrt(of(i, i)) : 0;
    factor_ = scale_.asDiagonal() * of * scale_.asDiagonal();
    for (std::size_t i = 0; i < order_.size(); ++i) order_[i] = static_cast<Eigen::Index>(i);
    for (rank_ = 0; rank_ < size; ++rank_) {
      Eigen::Index largest = rank_;
      for (Eigen::Index i = rank_ + 1; i < size; ++i)
        if (factor_(i, i) > factor_(largest, largest)) largest = i;
      if (!(factor_(largest, largest) > least)) return;
      exchange(rank_, largest);
      eliminate();
    }
  }

  /// x with P x = b, for b in the range of P.
  void solve(Eigen::Ref<Eigen::VectorXd const> const& b, Eigen::Ref<Eigen::VectorXd> x) {
    right_.resize(rank_);
    for (Eigen::Index i = 0; i < rank_; ++i) right_(i) = scale_(at(i)) * b(at(i));
    auto const lower = factor_.topLeftCorner(rank_, rank_).triangularView<Eigen::Lower>();
    lower.solveInPlace(right_);
    lower.transpose().solveInPlace(right_);
    x.setZero();
    for (Eigen::Index i = 0; i < rank_; ++i) x(at(i)) = scale_(at(i)) * right_(i);
  }

 private:
  Eigen::Index at(Eigen::Index place) const { return order_[static_cast<std::size_t>(place)]; }

  void exchange(Eigen::Index a, Eigen::Index b) {
    if (a == b) return;
    factor_.row(a).swap(factor_.row(b));
    factor_.col(a).swap(factor_.col(b));
    std::swap(order_[static_cast<std::size_t>(a)], order_[static_cast<std::size_t>(b)]);
  }

  /// The column of the factor at the pivot, and what is left of the others. The matrix is kept whole, so that it can be exchanged.
  void eliminate() {
    Eigen::Index const rest = factor_.rows() - rank_ - 1;
    double const root = std::sqrt(factor_(rank_, rank_));
    factor_(rank_, rank_) = root;
    factor_.col(rank_).tail(rest) /= root;
    factor_.bottomRightCorner(rest, rest).noalias() -= factor_.col(rank_).tail(rest) * factor_.col(rank_).tail(rest).transpose();
  }

  Eigen::VectorXd scale_, right_;
  Eigen::MatrixXd factor_;
  std::vector<Eigen::Index> order_;
  Eigen::Index rank_ = 0;
};

class Pass {
 public:
  Pass(SmoothingRecords const& layout, ConstLanes records, int lane)
      : layout_(layout),
        records_(records),
        lane_(lane),
        size_(layout.states),
        before_(size_, size_),
        past_(size_, size_),
        gain_(size_, size_),
        covariance_(size_, size_),
        change_(size_, size_),
        mean_(size_),
        correction_(size_),
        with_sum_(size_),
        weights_(size_),
        inverse_(size_) {}

  SmoothedPath run(std::vector<double> const& lengths) {
    int const samples = static_cast<int>(lengths.size()) + 1;
    auto const count = static_cast<std::size_t>(samples), n = static_cast<std::size_t>(size_);
    SmoothedPath path;
    path.mean.resize(count * n);
    path.covariance.resize(count * n * n);
    path.average.assign(count * static_cast<std::size_t>(layout_.noises), std::numeric_limits<double>::quiet_NaN());
    path.average_variance = path.average;
    read(samples - 1, layout_.mean_after, mean_);
    read(samples - 1, layout_.covariance_after, covariance_);
    store(samples - 1, path);
    for (int k = samples - 2; k >= 0; --k) {
      read(k + 1, layout_.mean_before, correction_);
      correction_ = mean_ - correction_;
      read(k + 1, layout_.covariance_before, before_);
      inverse_.factor(before_);
      for (int d = 0; d < layout_.noises; ++d)
        average(k, d, lengths[static_cast<std::size_t>(k)], static_cast<std::size_t>(d) * count + static_cast<std::size_t>(k),
                path);
      step_back(k);
      store(k, path);
    }
    return path;
  }

 private:
  double at(int sample, int record) const { return record < 0 ? 0 : records_(sample * layout_.count + record, lane_); }

  template <class To>
  void read(int sample, std::vector<int> const& from, To& to) const {
    for (Eigen::Index i = 0; i < to.rows(); ++i)
      for (Eigen::Index j = 0; j < to.cols(); ++j) to(i, j) = at(sample, from[static_cast<std::size_t>(i * to.cols() + j)]);
  }

  void average(int k, int d, double length, std::size_t place, SmoothedPath& path) {
    for (Eigen::Index i = 0; i < size_; ++i) with_sum_(i) = at(k + 1, layout_.noise[static_cast<std::size_t>(d * size_ + i)]);
    inverse_.solve(with_sum_, weights_);
    double const variance =
        at(k + 1, layout_.sum[static_cast<std::size_t>(d)]) - with_sum_.dot(weights_) + weights_.dot(covariance_ * weights_);
    path.average[place] = weights_.dot(correction_) / length;
    path.average_variance[place] = std::max(variance, 0.0) / (length * length);
  }

  void step_back(int k) {
    read(k + 1, layout_.past, past_);
    for (Eigen::Index j = 0; j < size_; ++j) {
      inverse_.solve(past_.col(j), weights_);
      gain_.row(j) = weights_.transpose();
    }
    read(k, layout_.mean_after, mean_);
    mean_.noalias() += gain_ * correction_;
    change_.noalias() = gain_ * (covariance_ - before_);
    read(k, layout_.covariance_after, covariance_);
    covariance_.noalias() += change_ * gain_.transpose();
    covariance_ = 0.5 * (covariance_ + covariance_.transpose()).eval();
  }

  void store(int k, SmoothedPath& path) const {
    std::copy(mean_.data(), mean_.data() + size_, path.mean.begin() + static_cast<std::ptrdiff_t>(k) * size_);
    std::copy(covariance_.data(), covariance_.data() + size_ * size_,
              path.covariance.begin() + static_cast<std::ptrdiff_t>(k) * size_ * size_);
  }

  SmoothingRecords const& layout_;
  ConstLanes records_;
  int lane_;
  Eigen::Index size_;
  Eigen::MatrixXd before_, past_, gain_, covariance_, change_;
  Eigen::VectorXd mean_, correction_, with_sum_, weights_;
  Covariance inverse_;
};

}  // namespace

SmoothedPath smooth(SmoothingRecords const& layout, ConstLanes records, int lane, std::vector<double> const& lengths) {
  return Pass(layout, records, lane).run(lengths);
}

}  // namespace sysid
