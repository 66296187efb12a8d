// The powers of the likelihood between prior and posterior that replicas of a chain have, and how easily neighbours are exchanged.
#pragma once
#include <nlohmann/json.hpp>
#include <vector>

namespace sysid::tempering {

/// p_k(x) = prior(x) likelihood(x)^b_k,  1 = b_0 > b_1 > ... > b_(K-1) = 0. The states of neighbours k and k + 1 are exchanged with
/// probability min(1, exp((b_k - b_(k+1)) (l_(k+1) - l_k))), l the log likelihoods.                       Swendsen and Wang 1986
class Ladder {
 public:
  Ladder() = default;
  /// K = rungs >= 2. The first powers lie closer towards 0, where a likelihood of many samples changes most.
  explicit Ladder(int rungs);

  double power(int rung) const { return powers_[static_cast<std::size_t>(rung)]; }
  /// The probability above, for neighbours `rung` and `rung` + 1.
  double probability(int rung, double log_likelihood, double log_likelihood_above) const;
  void count(int rung, double probability);

  /// Moves the powers so that all neighbours are exchanged equally often, and begins to count anew.
  ///
  /// The sum of the rejection rates up to a power hardly depends on the other powers: it is cut into equal parts.
  ///                                                                        Syed, Bouchard-Cote, Deligiannidis and Doucet 2022
  void equalise();
  void forget_counts();

  /// The share of exchanges accepted between the neighbours that are exchanged least, since counts began; 1 without any.
  double least_acceptance() const;
  /// The sum of the rejection rates: neighbours are exchanged half of the time with twice as many rungs.
  double barrier() const;

  nlohmann::json store() const;
  static Ladder restore(nlohmann::json const& stored, int rungs);

 private:
  double rejection(std::size_t rung) const;

  std::vector<double> powers_;         // [K]
  std::vector<double> sums_, counts_;  // [K - 1] of probabilities
};

}  // namespace sysid::tempering
