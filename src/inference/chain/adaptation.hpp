// Learns a full-covariance proposal during burn-in from the chains that started in one mode; afterwards it is frozen.
#pragma once
#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <vector>

#include "inference/chain/metropolis.hpp"

namespace sysid::metropolis {

/// Covariance after Haario, Saksman and Tamminen (2001), scale by Robbins and Monro to an acceptance of 0.234 (Roberts, Gelman and
/// Gilks 1997). Chains of one group share covariance and scale, each about its own mean: chains that are still apart must not read
/// as width. Weights 2/n forget the first half of burn-in twice as fast as a plain mean, since the way from the start is not the
/// posterior.
class Adaptation {
 public:
  Adaptation() = default;
  /// chains: lanes of the group. covariance: [P x P], the first guess (Laplace, or the prior's).
  Adaptation(std::vector<int> chains, Eigen::MatrixXd covariance);

  /// After each iteration of burn-in. `away` [W]: chains that stand nearer to another mode than to the one they started in; they
  /// tell nothing of the width here. The scale learns from the random walk's moves alone.
  void learn(State const& state, Info const& info, std::span<char const> away);
  /// The proposal to use now; its factor follows the covariance every tenth iteration.
  Proposal const& proposal() const { return proposal_; }
  std::vector<int> const& chains() const { return chains_; }
  /// The mean over all chains, and the covariance about it: what is between their means counts as width here. Before the first
  /// iteration there is no mean (empty).
  Eigen::VectorXd mean() const;
  Eigen::MatrixXd covariance() const;

  nlohmann::json store() const;
  /// Throws checkpoint::Mismatch for another number of parameters or chains.
  static Adaptation restore(nlohmann::json const& stored, int parameters, int chains);

 private:
  void learn_scale(Info const& info);
  void learn_shape(State const& state, std::span<char const> away);
  void refactor();

  std::vector<int> chains_;
  Eigen::MatrixXd first_;  // keeps the covariance positive definite while chains have not moved yet
  Eigen::MatrixXd covariance_;
  Eigen::MatrixXd mean_;  // [P x chains of the group]
  double log_scale_ = 0;
  std::uint64_t iteration_ = 0, walks_ = 0;  // of these, with a move of the random walk
  Proposal proposal_;
};

}  // namespace sysid::metropolis
