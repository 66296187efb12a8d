// Sets of terms with their weights: what methods share that give each a probability.
#pragma once
#include <vector>

#include "regression/choice/selector.hpp"
#include "regression/choice/triangle.hpp"

namespace sysid::regression {

using Bits = std::vector<bool>;  // over the selectable terms

struct Weighed {
  Bits support;
  double log_evidence = 0;  // against the always terms
  double log_weight = 0;    // with the prior
  double probability = 0;   // once that is known
  double error = 0;         // of it, where it is sampled
};

/// The priors that settings state: of coefficients and of sets of terms.
class Scale {
 public:
  /// triangle: must outlive it.
  Scale(LinearProblem const& problem, Triangle const& triangle, Settings const& settings);

  std::vector<int> always, selectable;

  std::vector<int> terms(Bits const& support) const;
  Weighed weigh(Bits support, double squares) const;
  Weighed weigh(Bits support) const;

  CoefficientPrior prior() const { return prior_; }
  /// Rows less the always terms.
  double rows() const { return n_; }
  double g() const { return g_; }
  /// log prior of a set of so many selectable terms, up to a constant.
  double log_prior(double size) const;

 private:
  Triangle const& triangle_;
  double n_, g_, base_;
  CoefficientPrior prior_;
  bool beta_binomial_;
};

/// Terms, coefficients and supports from sets with probabilities, the most probable first. Keeps those terms whose inclusion
/// probability is above the setting `keep`; reports as many sets as `supports` says.
void summarise(LinearProblem const& problem, Triangle const& triangle, Scale const& scale, std::vector<Weighed> weighed,
               Settings const& settings, Choice& choice);

}  // namespace sysid::regression
