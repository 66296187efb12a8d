// The share of a channel's variance that a fit or a prediction must explain.
#pragma once
#include <cstddef>
#include <string>
#include <vector>

#include "result/finding.hpp"

namespace sysid {

/// `worse_than_the_mean` of a channel, with what to do.
Finding worse_than_the_mean(Severity severity, std::vector<std::string> names, std::string const& channel, double nmse,
                            std::string help);

/// nmse [%] from which a model is none of its record, whatever its residuals: the error is larger than what there was to explain.
inline constexpr double useless_nmse = 200;

/// The nmse [%] that a prediction exceeds by chance once in a thousand records where the mean explains all there is. Of n samples
/// of noise about the right prediction the sums of squares about it and about the mean differ by less than sigma^2 chi-squared(2),
/// and the second is sigma^2 chi-squared(n - 1): their quotient is that of an F(2, n - 1) variable, whose quantiles are powers,
///
///   nmse = 100 p^(-2/(n - 1)),   about 100 (1 + 13.8/n) for many samples and p = 0.001
///
/// A channel that did not change has no nmse, which exceeds nothing.
double as_bad_as_the_mean(std::size_t samples);

}  // namespace sysid
