// The selectors, one line each, and what they share.
#include <algorithm>
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "core/setting/table.hpp"
#include "regression/choice/ard.hpp"
#include "regression/choice/forward.hpp"
#include "regression/choice/reversible_jump.hpp"
#include "regression/choice/selector.hpp"
#include "regression/choice/spike_slab.hpp"
#include "regression/choice/threshold.hpp"
#include "regression/choice/triangle.hpp"

namespace sysid::regression {
namespace {

SelectorRow const selector_rows[] = {
    {"spike_slab", "posterior probabilities of terms and of sets of terms", "inclusion probability", spike_slab::settings(),
     &no_refusal, &spike_slab::choose},
    {"reversible_jump", "chains over sets of terms by birth, death and exchange of terms, with Monte Carlo errors",
     "inclusion probability", reversible_jump::settings(), &reversible_jump::refuse, &reversible_jump::choose},
    {"ard", "a prior precision for each coefficient, chosen such that the evidence is largest", "contribution", ard::settings(),
     &no_refusal, &ard::choose},
    {"threshold", "removes the term with the smallest contribution, repeatedly", "contribution", threshold::settings(), &no_refusal,
     &threshold::choose},
    {"forward", "repeatedly adds the term that explains most of the remaining variance", "error reduction ratio",
     forward::settings(), &no_refusal, &forward::choose},
};

}  // namespace

std::span<SelectorRow const> selectors() { return selector_rows; }

SelectorRow const* find_selector(std::string_view name) { return row_named(selector_rows, name); }

Support least_squares(LinearProblem const& problem, std::vector<int> terms) {
  return support_of(reduce(problem), std::move(terms));
}

double log_bayes_factor(CoefficientPrior prior, double n, double p, double squares, double base, double g) {
  if (!(base > 0)) return 0;
  // What is left of exact data is rounding: 1e-30 of the squares keeps the logarithm finite.
  double const q = std::clamp(squares / base, 1e-30, 1.0), log_q = elementary::log(q);
  switch (prior) {
    case CoefficientPrior::beta_prime:
      return elementary::lgamma(p / 2 + 0.25) + elementary::lgamma((n - p) / 2) - elementary::lgamma(0.25) -
             elementary::lgamma(n / 2) - ((n - p) / 2 - 0.25) * log_q;
    case CoefficientPrior::unit_information:
      return -p / 2 * elementary::log1p(g) - n / 2 * log_q;
    case CoefficientPrior::zellner:
      return (n - p) / 2 * elementary::log1p(g) - n / 2 * elementary::log1p(g * q);
  }
  return 0;
}

}  // namespace sysid::regression
