// The metric of Hamiltonian trajectories: an estimate of the posterior's covariance, in whose units all momenta are normal.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

namespace sysid::nuts {

/// covariance = L L^T. Momenta p of theta are r = L^T p in its units: r ~ N(0, I), kinetic energy |r|^2 / 2.
struct Metric {
  int dimension = 0;           // P
  bool dense = true;           // else L is diagonal
  std::vector<double> factor;  // L: lower triangle of [P x P] by rows, or its diagonal [P]

  /// d theta / d time = L r.
  void velocity(std::span<double const> momentum, std::span<double> out) const;
  /// d r / d time = L^T gradient of the log density.
  void force(std::span<double const> gradient, std::span<double> out) const;
  /// L^-1 x, in place.
  void whiten(std::span<double> x) const;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor(dimension), visitor(dense), visitor(factor);
  }
};

/// covariance: [P x P]; without `dense` its diagonal alone is read.
Metric metric_of(Eigen::MatrixXd const& covariance, bool dense);

/// Mean and covariance of states in units of a metric, and the metric that follows from them.
class WindowOfDraws {
 public:
  void add(Metric const& metric, std::span<double const> theta, bool moved);
  /// The metric whose covariance is L C* L^T, with C* the covariance C of the window's states in units of L, but for what chance
  /// explains: eigenvalues of C between
  ///
  ///   (1 - sqrt(P/n))^2 and (1 + sqrt(P/n))^2                                                      Marchenko and Pastur 1967
  ///
  /// are 1, as those of n independent draws from the metric itself would lie there (where P > n, the lower bound is 0). The others
  /// are raised to the power N/(N + 5), N the number of different states: half as many count as independent (n = N/2). Of a
  /// diagonal metric the same holds for each coordinate alone (P = 1). So the estimate shrinks to the metric in use, which at first
  /// is that of the Laplace approximation. The metric as it is where the chain has moved less than ten times.
  Metric estimate(Metric const& metric) const;
  void clear() { *this = {}; }
  /// Whether what it holds is of the dimension and form of `metric`.
  bool fits(Metric const& metric) const;

  template <class Visitor>
  void visit(Visitor& visitor) {
    visitor(count_), visitor(moves_), visitor(reference_), visitor(mean_), visitor(squares_);
  }

 private:
  std::uint64_t count_ = 0, moves_ = 0;
  std::vector<double> reference_;  // [P] the first state: others are whitened relative to it
  std::vector<double> mean_;       // [P], whitened
  std::vector<double> squares_;    // sum of products about the mean: [P x P], or its diagonal [P]
};

}  // namespace sysid::nuts
