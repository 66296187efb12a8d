// How far the empirical distribution of ranks may lie from the uniform one: simultaneous bands and the p value of their test
// (Säilynoja, Bürkner and Vehtari 2022).
#pragma once
#include <span>
#include <vector>

namespace sysid {

/// Counts of ranks below k that are allowed, k = 1 .. values - 1.
struct CountBands {
  std::vector<int> low, high;
  double pointwise = 0;  // gamma: what each count alone may exceed its limits with
};

/// For n ranks that are uniform on 0 .. values - 1 the counts R_k of ranks below k are binomial, and a chain in k:
///
///   R_k ~ binomial(n, k/values),   R_(k+1) - R_k | R_k ~ binomial(n - R_k, 1/(values - k))
///
/// so that the probability that all of them stay within limits is a sum along k, without simulation. The limits of each count
/// leave out gamma/2 at either end, gamma chosen so that all counts stay inside with probability `level` at least.
CountBands ecdf_bands(int n, int values, double level);

/// The probability that all counts stay within [low, high].
double probability_within(int n, int values, std::vector<int> const& low, std::vector<int> const& high);

/// P(some count is as rare as the rarest that is seen), ranks each in 0 .. values - 1. 1 of none.
double ecdf_p_value(std::span<int const> ranks, int values);

/// The ranks in `bins` groups of equal size (bins divides values): P(chi-square(bins - 1) > what is seen). 1 of none.
double chi_squared_p_value(std::span<int const> ranks, int values, int bins);

/// As many groups as leave ten ranks in each, at most 20, a divisor of `values`; at least 2.
int rank_bins(int n, int values);

}  // namespace sysid
