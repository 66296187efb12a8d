// The joint normal density of the samples of a linear model in a hundred digits: a reference for likelihoods that double precision
// can hardly compute as one determinant, and by differences for their exact derivatives.
#pragma once
#include <Eigen/Dense>
#include <boost/multiprecision/cpp_bin_float.hpp>
#include <boost/multiprecision/eigen.hpp>
#include <vector>

#include "likelihood/linear_system.hpp"

namespace sysid::test {

using Precise = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<100>, boost::multiprecision::et_off>;
using PreciseMatrix = Eigen::Matrix<Precise, Eigen::Dynamic, Eigen::Dynamic>;
using PreciseVector = Eigen::Matrix<Precise, Eigen::Dynamic, 1>;

/// As LinearSystem.
struct PreciseSystem {
  PreciseMatrix a, b, g, h;
  PreciseVector start;
  PreciseMatrix start_covariance, q, r;
};

inline PreciseMatrix precise_exponential(PreciseMatrix const& a) {
  constexpr int halvings = 60, degree = 12;
  PreciseMatrix const z = a / pow(Precise(2), halvings);
  PreciseMatrix power = PreciseMatrix::Identity(a.rows(), a.cols()), sum = power;
  for (int k = 1; k <= degree; ++k) {
    power = (power * z / Precise(k)).eval();
    sum += power;
  }
  for (int k = 0; k < halvings; ++k) sum = (sum * sum).eval();
  return sum;
}

/// Of equal steps: the mean one of these times.
inline Precise precise_density(PreciseSystem const& system, std::vector<double> const& time, Eigen::MatrixXd const& u,
                               Eigen::MatrixXd const& y) {
  auto const n = system.a.rows(), inputs = system.b.cols();
  auto const samples = static_cast<Eigen::Index>(time.size());
  Precise const step = (Precise(time.back()) - Precise(time.front())) / Precise(samples - 1);
  PreciseMatrix block = PreciseMatrix::Zero(2 * n, 2 * n), forced = PreciseMatrix::Zero(n + inputs, n + inputs);
  block.topLeftCorner(n, n) = -system.a * step;
  block.topRightCorner(n, n) = system.g * system.q * system.g.transpose() * step;
  block.bottomRightCorner(n, n) = system.a.transpose() * step;
  forced.topLeftCorner(n, n) = system.a * step;
  forced.topRightCorner(n, inputs) = system.b * step;
  PreciseMatrix const power = precise_exponential(block), transition = power.bottomRightCorner(n, n).transpose();
  PreciseMatrix const added = transition * power.topRightCorner(n, n);
  PreciseMatrix const response = precise_exponential(forced).topRightCorner(n, inputs);
  std::vector<PreciseVector> mean{system.start};
  std::vector<PreciseMatrix> covariance{system.start_covariance};
  for (Eigen::Index k = 0; k + 1 < samples; ++k) {
    mean.push_back(transition * mean.back() + response * u.col(k).cast<Precise>());
    covariance.push_back(transition * covariance.back() * transition.transpose() + added);
  }
  std::vector<std::pair<Eigen::Index, Eigen::Index>> seen;
  for (Eigen::Index k = 0; k < samples; ++k)
    for (Eigen::Index c = 0; c < system.h.rows(); ++c)
      if (!std::isnan(y(c, k))) seen.emplace_back(k, c);
  auto const count = static_cast<Eigen::Index>(seen.size());
  std::vector<PreciseMatrix> powers{PreciseMatrix::Identity(n, n)};
  while (static_cast<Eigen::Index>(powers.size()) < samples) powers.push_back(transition * powers.back());
  PreciseMatrix of_samples(count, count);
  PreciseVector left(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    auto const [k, c] = seen[static_cast<std::size_t>(i)];
    left(i) = Precise(y(c, k)) - system.h.row(c).dot(mean[static_cast<std::size_t>(k)]);
    for (Eigen::Index j = 0; j <= i; ++j) {
      auto const [l, d] = seen[static_cast<std::size_t>(j)];
      PreciseVector const with = covariance[static_cast<std::size_t>(l)] * system.h.row(d).transpose();
      of_samples(i, j) =
          system.h.row(c).dot(powers[static_cast<std::size_t>(k - l)] * with) + (i == j ? system.r(c, c) : Precise(0));
    }
  }
  // The factor of Cholesky, by rows.
  Precise result = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      Precise sum = of_samples(i, j);
      for (Eigen::Index k = 0; k < j; ++k) sum -= of_samples(i, k) * of_samples(j, k);
      of_samples(i, j) = i == j ? Precise(sqrt(sum)) : Precise(sum / of_samples(j, j));
    }
    for (Eigen::Index k = 0; k < i; ++k) left(i) -= of_samples(i, k) * left(k);
    left(i) /= of_samples(i, i);
    result -= left(i) * left(i) / 2 + log(of_samples(i, i)) + log(boost::math::constants::two_pi<Precise>()) / 2;
  }
  return result;
}

/// That of `filtered_text`: m, c, k, q, sigma.
inline PreciseSystem precise_oscillator(std::vector<Precise> const& values, Precise const& start_variance) {
  Precise const m = values[0], c = values[1], k = values[2], q = values[3], sigma = values[4];
  PreciseSystem system;
  system.a = PreciseMatrix::Zero(2, 2);
  system.a(0, 1) = 1;
  system.a(1, 0) = -k / m;
  system.a(1, 1) = -c / m;
  system.b = PreciseMatrix::Zero(2, 1);
  system.b(1, 0) = 1 / m;
  system.g = system.b;
  system.h = PreciseMatrix::Zero(2, 2);
  system.h(0, 0) = system.h(1, 1) = 1;
  system.h(1, 0) = Precise(0.5);
  system.start = PreciseVector::Zero(2);
  system.start(0) = Precise(0.005);
  system.start_covariance = PreciseMatrix::Identity(2, 2) * start_variance;
  system.q = PreciseMatrix::Constant(1, 1, q);
  system.r = PreciseMatrix::Zero(2, 2);
  system.r(0, 0) = sigma * sigma;
  system.r(1, 1) = Precise(0.03) * Precise(0.03);
  return system;
}

}  // namespace sysid::test
