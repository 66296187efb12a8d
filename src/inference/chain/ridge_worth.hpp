// Learns during burn-in whether moves along ridges are worth what they cost.
#pragma once
#include <Eigen/Core>
#include <array>
#include <nlohmann/json.hpp>
#include <span>

#include "inference/chain/metropolis.hpp"

namespace sysid::metropolis {

/// Moves along ridges are there for places that the mixture of the independence moves hardly reaches. So the squared jumps out of a
/// state x count by its weight w(x) = p(x)/q(x), q the density of the mixture: of the states that a chain draws from p the mean is
/// that over p with p/q beside it, which the stays decide. For each parameter
///
///   r = (sum w jump^2 / sum w per simulation) of moves along ridges, over the same of all others,
///
/// and a window says the largest r of all parameters. The moves are worth their cost while the geometric mean of what the windows
/// said, each taken as at least 1/1000 and at most 1000, is 1 or more; two windows decide at the earliest.
class RidgeWorth {
 public:
  /// After an iteration: the states before it [P x W], log w of each up to a constant, those after it, and its moves.
  void learn(ConstLanes before, std::span<double const> log_weights, ConstLanes after, Info const& info);
  /// Simulations that a batch took, of moves along ridges or of others.
  void spend(bool along_ridges, std::uint64_t simulations);
  void end_window();
  /// Whether they are worth it as far as is known.
  bool worth() const { return windows_ < 2 || log_ratios_ >= 0; }

  nlohmann::json store() const;
  /// Throws checkpoint::Mismatch where it is neither empty nor of dimension P.
  static RidgeWorth restore(nlohmann::json const& stored, int dimension);

 private:
  struct Kind {
    Eigen::VectorXd jumps;  // [P], sum of w times squared jump
    double weight = 0;      // sum of w
    std::uint64_t moves = 0, simulations = 0;
  };
  std::array<Kind, 2> kinds_;  // others, along ridges
  double log_highest_ = 0;     // of the weights of the window, which are taken over the highest
  double log_ratios_ = 0;      // sum over windows
  std::uint64_t windows_ = 0;
};

}  // namespace sysid::metropolis
