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
/// of noise about the right prediction the sum of squares about it exceeds the sum about their mean by sigma^2 chi-squared(1), and
/// that sum is sigma^2 chi-squared(n - 1), independent of it:
///
///   nmse = 100 (1 + t^2/(n - 1)),   t the quantile of Student's t with n - 1 degrees of freedom; 100 (1 + 10.8/n) of many samples
///
/// A channel that did not change has no nmse, which exceeds nothing.
double as_bad_as_the_mean(std::size_t samples);

}  // namespace sysid
