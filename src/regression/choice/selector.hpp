// Choosing the terms of a linear regression: one interface, one row of a table per method.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/setting/settings.hpp"
#include "core/system/progress.hpp"

namespace sysid::regression {

/// known = terms * coefficients + independent noise of one unknown sd. Columns have any scale and are linearly independent; a
/// selector's result does not depend on the scales.
struct LinearProblem {
  Eigen::VectorXd known;     // [K]
  Eigen::MatrixXd terms;     // [K x J]
  std::vector<char> always;  // [J] 1: part of every support
};

/// Terms that stand together, with their coefficients under least squares on them alone.
struct Support {
  std::vector<int> terms;        // rising
  Eigen::VectorXd coefficient;   // one per term of the support
  Eigen::MatrixXd covariance;    // of those, with the support's own noise estimate
  double noise_sd = 0;           // residual sd, K - |terms| degrees of freedom
  double log_evidence = 0;       // against the support of the `always` terms alone; all methods by `log_bayes_factor`
  double probability = 0;        // spike_slab, reversible_jump: posterior; else 0 or 1
  double probability_error = 0;  // one standard error, where it is sampled by reversible_jump
};

/// What happened to a term, and the number that decided it.
struct TermChoice {
  bool kept = false;
  double measure = 0;        // threshold: contribution when dropped, or at the end; ard: contribution at the evidence's maximum;
                             // spike_slab, reversible_jump: inclusion probability
  double measure_error = 0;  // one standard error, where it is sampled by reversible_jump
  double precision = 0;      // ard: of the coefficient's prior, column scaled to unit root mean square; infinite: dropped
  int dropped_in = 0;        // threshold: the round, from 1; 0: kept, or left out by an exchange
  double mean = 0,
         sd = 0;  // of the method: spike_slab and reversible_jump average over supports, ard's posterior; threshold: least squares
};

struct Choice {
  std::vector<TermChoice> terms;  // [J]
  Support chosen;
  std::vector<Support> supports;  // candidates, best first; the chosen one is among them, first where it is the best
  Eigen::MatrixXd joint;          // spike_slab, reversible_jump: [J x J] probability that both are in; else empty
  double noise_sd = 0;
  int iterations = 0;
  bool converged = true;
  bool exact = true;  // false: sampled
};

struct SelectorContext {
  std::uint64_t seed = 1;
  std::uint64_t equation = 0;              // keys the stream with the seed
  std::function<bool()> interrupted = {};  // empty: never
};

struct SelectorRow {
  std::string_view name;
  std::string_view summary;
  std::string_view measure;  // what `TermChoice::measure` is, for tables
  std::span<SettingRow const> settings;
  std::string (*refuse)(Settings const&);
  Choice (*choose)(LinearProblem const&, Settings const&, SelectorContext const&);
};

/// In the order in which they are listed; `spike_slab` first, the default.
std::span<SelectorRow const> selectors();
SelectorRow const* find_selector(std::string_view name);

/// Least squares on a support. terms: rising, linearly independent, fewer than K.
Support least_squares(LinearProblem const& problem, std::vector<int> terms);

/// How the coefficients of a support are spread before the data: normal with covariance g sigma^2 (A^T A)^-1, and
enum class CoefficientPrior {
  beta_prime,        // centred at zero, g unknown under a beta prime prior (Maruyama, George 2011, a = -3/4)
  unit_information,  // centred at the estimate, g given (Kass, Wasserman 1995: with g = n nearly the Schwarz criterion)
  zellner,           // centred at zero, g given (Liang et al. 2008, eq. 5)
};

/// log of the Bayes factor of a support with p selectable terms, which leaves `squares`, against the `always` terms alone, which
/// leave `base`; n rows less the always terms, q = squares / base, priors flat on the always terms and 1/sigma on the noise:
///
///   beta_prime         lgamma(p/2 + 1/4) + lgamma((n - p)/2) - lgamma(1/4) - lgamma(n/2) - ((n - p)/2 - 1/4) log q
///   unit_information   -p/2 log(1 + g) - n/2 log q
///   zellner            (n - p)/2 log(1 + g) - n/2 log(1 + g q)
///
/// As q falls to 0 zellner stays bounded: with little noise it no longer tells terms that matter a little from those that do
/// not matter. beta_prime grows without bound and asks the more of one more term the less the others leave (by sqrt(q) about).
double log_bayes_factor(CoefficientPrior prior, double n, double p, double squares, double base, double g);

}  // namespace sysid::regression
