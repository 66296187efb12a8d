// Integrals of one expression against the test functions of one record, with their sensitivity to every sample.
#pragma once
#include <Eigen/Core>
#include <map>
#include <span>
#include <tuple>
#include <vector>

#include "data/experiment.hpp"
#include "regression/column/dictionary.hpp"
#include "regression/weak/pieces.hpp"
#include "regression/weak/test_function.hpp"

namespace sysid::regression {

/// Where the test functions stand on a record, and what reads its samples.
struct Windows {
  std::vector<int> centres;                            // [K] rows of the record, rising
  int half = 0;                                        // samples
  int smoother_half = 0;                               // of the local polynomial behind smoothed derivatives; 0: none needed
  std::map<std::pair<int, int>, int> smoother_degree;  // of it, by channel and derivative
  double step = 0;                                     // s
};

/// d residual_k / d sample l = sum_i phi_k^(order)(t_i) s(i) dt * (i == l, or the smoother's weight of l for derivative
/// `smoothed`).
struct SensitivityKey {
  int channel = 0;
  int order = 0;     // derivatives of the test function
  int smoothed = 0;  // derivatives by the smoother
  auto operator<=>(SensitivityKey const&) const = default;
};
using Sensitivities = std::map<SensitivityKey, Eigen::VectorXd>;  // s: [N]

struct Integrals {
  Eigen::VectorXd rows;  // [K]
  Sensitivities sensitivities;
};

class WeakIntegrals {
 public:
  WeakIntegrals(Dictionary& dictionary, Experiment const& experiment, TestFunction const& test, Windows windows);

  Integrals of(std::vector<Piece> const& pieces);
  /// G_c [2 reach + 1 x K] of combined sensitivities: column k holds samples centre - reach .. centre + reach.
  Eigen::MatrixXd gradient(Sensitivities const& sensitivities, int channel) const;
  /// Likewise d known side / d its own value at the samples.
  Eigen::MatrixXd known_gradient() const;
  /// half + smoother_half.
  int reach() const { return windows_.half + windows_.smoother_half; }
  Windows const& windows() const { return windows_; }

 private:
  std::vector<double> const& samples(int channel) const;
  std::vector<double> const& test_weights(int order);
  void integrate(int order, Eigen::VectorXd const& values, Eigen::VectorXd& rows);
  std::vector<double> const& smoothed(int channel, int derivative);
  std::vector<double> smoother(int channel, int derivative) const;
  /// roots at the samples, inputs read from one side.
  Eigen::MatrixXd at_samples(std::span<NodeId const> roots, bool after);
  void add_inputs(Piece const& piece, Integrals& integrals);
  void add_samples(Piece const& piece, Integrals& integrals);
  void add_moved(Piece const& piece, Integrals& integrals);
  void add_potential(Piece const& piece, Integrals& integrals);

  Dictionary& dictionary_;
  Experiment const& experiment_;
  TestFunction const& test_;
  Windows windows_;
  int rows_;
  std::map<int, std::vector<double>> weights_;                      // by order: phi^(order)(t_i) dt
  std::map<std::pair<int, int>, std::vector<double>> smoothed_;     // by channel and derivative
  std::map<std::tuple<int, int, bool>, std::vector<double>> side_;  // input, order, after: limits at the samples
};

}  // namespace sysid::regression
