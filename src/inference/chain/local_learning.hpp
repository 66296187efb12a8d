// Learns during burn-in how far autoregressive moves go, and which of the two kinds of local moves a chain makes.
#pragma once
#include <nlohmann/json.hpp>

#include "inference/chain/metropolis.hpp"

namespace sysid::metropolis {

/// Autoregressive moves are made where too few independence moves are accepted. Their step is tuned to an acceptance of 0.4, or is
/// 1 where more are accepted even then. They are half of the local moves, since walks alone lead out of tails that the mixture
/// hardly reaches; but one in ten after a window of burn-in in which their expected squared jump, the mean of acceptance
/// probability times squared jump over the proposal's covariance, was the smaller one. Both kinds cost one simulation.
class LocalLearning {
 public:
  double step() const { return step_; }
  /// Of autoregressive moves among local ones.
  double share() const { return share_; }

  /// After every iteration of burn-in.
  void learn(Info const& info);
  /// wanted: whether there are to be autoregressive moves.
  void end_window(bool wanted);

  nlohmann::json store() const;
  static LocalLearning restore(nlohmann::json const& stored);

 private:
  /// What the moves of one kind came to in a window.
  struct Worth {
    double jump = 0;  // sum of acceptance probability times squared jump
    std::uint64_t moves = 0;
    double mean() const { return moves > 0 ? jump / static_cast<double>(moves) : 0; }
  };
  Worth walk_, autoregressive_;
  double log_step_ = -0.6931471805599453, step_ = 0.5, share_ = 0;
  std::uint64_t iterations_ = 0;  // with an autoregressive move
};

}  // namespace sysid::metropolis
