// Moves along ridges and sheets: a step along where the density is long, then back onto it across, however it bends.
#pragma once
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include "inference/chain/metropolis.hpp"

namespace sysid::metropolis {

/// In widths of the prior, with the gradient g and the curvature H = J'J + P of Gauss and Newton, to which 1 is added, so that no
/// direction is longer than a prior width: the columns of T(x) [P x d] are the eigenvectors of H(x) along which the density is
/// long, d at most 3, those of N(x) the others.
///
///   x' = m + N(x) c,   c ~ N(0, (N(x)'H(m) N(x))^-1),   m the top of the plane through x + T(x) t across T(x),
///   t_k ~ N((1 - sqrt(1 - min(1, s)^2)) l_k^2 T_k(x)'g(x), (s l_k)^2),   l_k the lengths by H(x),
///
/// s log-uniform within a factor of 1.5 of what burn-in learns. m is found by Newton steps in the plane, a function of x and t
/// alone. So the density of x' given x is that of t and c, and that of x given x' follows from the plane through T(x')'(x - x'): x'
/// is accepted as by Hastings. How the ridge bends does not limit the step as long as the plane meets it, and what is across is
/// drawn anew. A move costs some ten curvatures.
class RidgeMoves {
 public:
  /// None.
  RidgeMoves() = default;
  /// scale [P]: the widths of the prior.
  explicit RidgeMoves(Eigen::VectorXd scale) : scale_(std::move(scale)) {}

  bool active() const { return scale_.size() > 0; }
  /// One move of every chain; keys as of metropolis::step. Interrupted, it has changed nothing.
  Info step(Target const& target, StreamKey key, State& state, Ledger& ledger) const;
  /// After a step of burn-in.
  void learn(Info const& info);

  nlohmann::json store() const;
  /// Throws checkpoint::Mismatch where it is neither empty nor of dimension P.
  static RidgeMoves restore(nlohmann::json const& stored, int dimension);

 private:
  Eigen::VectorXd scale_;
  double log_length_ = 0;  // log s
  std::uint64_t steps_ = 0;
};

}  // namespace sysid::metropolis
