// Means, spreads and quantiles of samples. Where two functions compute one quantity, their orders of rounding differ, and results
// keep their last bit: each says which order it takes.
#pragma once
#include <span>
#include <utility>
#include <vector>

namespace sysid {

/// The normal's 95 % quantile: how many sds its central 90 % reach to either side.
inline constexpr double normal_quantile_95 = 1.6448536269514722;
/// The sd of a normal over the median of its absolute deviations.
inline constexpr double sd_of_mad = 1.4826;

/// Arithmetic mean: the values summed in their order, over their number. NaN of none.
double mean(std::span<double const> values);
/// Sum of (v - center)^2 in the order of the values; divide it by n for the variance of a population, by n - 1 for the unbiased
/// estimate from a sample.
double squared_deviations(std::span<double const> values, double center);
/// Variance with the divisor n - 1 about `mean`; NaN of fewer than two values.
double sample_variance(std::span<double const> values);
/// Variance with the divisor n about `mean`; NaN of none.
double population_variance(std::span<double const> values);

/// Mean and variance (divisor n - 1) to the last digit, for files that are compared with those of other programs: the mean is
/// corrected by the mean of what it leaves, and what the additions of the squares round off is summed beside.     Neumaier 1974
double corrected_mean(std::span<double const> values);
double corrected_variance(std::span<double const> values);
/// mean: theirs, corrected.
double corrected_variance(std::span<double const> values, double mean);

/// log(exp(a) + exp(b)); -infinity is the log of nothing.
double log_of_sum(double a, double b);
/// The same of several, added in their order; of none: -infinity. NaN where the first is.
double log_of_sum(std::span<double const> logs);
/// Log of the mean of their exponentials, which are added in their order; of none: -infinity.
double log_of_mean(std::span<double const> logs);

/// How many equal weights these are worth: (sum w)^2 / sum w^2, sums in the order of the weights; 0 where all are 0.     Kish 1965
double effective_number(std::span<double const> weights);

/// All chains, one behind the other.
std::vector<double> pooled(std::vector<std::vector<double>> const& chains);

/// Quantile of type 7 (R's default), draws need not be sorted. NaN of none, and where one is NaN.
double quantile(std::vector<double> draws, double probability);
/// The same of draws that rise and are not empty.
double sorted_quantile(std::vector<double> const& sorted, double probability);
/// Quantile of type 6, of draws in any order, which changes; they are not empty. Between those of 2.5 % and 97.5 % another draw
/// falls with probability 0.95 however few draws there are, from 39 on; between those of type 7, 0.931 with 100.
double predictive_quantile(std::span<double> draws, double probability);
/// Where it lies among so many draws in order: at a share of the way between two of them.
struct PredictivePlace {
  std::size_t below, above;
  double share;
};
PredictivePlace predictive_place(std::size_t draws, double probability);
/// Quantile of type 7 of one half: of an even number of draws the mean of the middle two.
double median(std::vector<double> draws);
/// The middle draw, of an even number the larger of the middle two: always one of the draws, and infinite where half of them are.
/// draws: not empty, no NaN.
double upper_median(std::vector<double> draws);

/// Smallest and largest finite value; {0, 1} when there is none.
std::pair<double, double> finite_range(std::vector<double> const& values);

}  // namespace sysid
