// The normal distribution nearest to a noise: what a filter of means and covariances searches with before particles take over.
#pragma once
#include "distribution/distribution.hpp"

namespace sysid {

/// The normal distribution of its mean and variance, where these are finite. Of student_t with few degrees of freedom n the factor
/// n/(n - 2) of the variance is at most 2 n + 4; of counts the variance is at least 1/4, so that a mean of 0 is a place like
/// others. noise: without bounds.
Distribution normal_approximation(Graph& graph, Distribution const& noise);

}  // namespace sysid
