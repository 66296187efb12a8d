// What the uncertainty of parameters inside terms adds to that of coefficients, which a regression has at one value of them.
#pragma once
#include <span>
#include <vector>

#include "check/checked/checked.hpp"
#include "data/experiment.hpp"
#include "regression/discovery.hpp"

namespace sysid {

/// sds of the parameters [inner], coherent SI, at values where the log evidence is largest; by Laplace's method, with its
/// curvature at fixed terms. Added to the covariance C of the coefficients b of each equation,
///
///   C + (db/da) C_a (db/da)^T
///
/// and so to sds of the terms. Empty where the curvature cannot be found: a bound of a prior is near, it is no maximum, or some
/// regression nearby does not list the same terms; `found` is then as before.
std::vector<double> add_inner_spread(CheckedDictionary const& dictionary, std::span<Experiment const> experiments,
                                     regression::Method const& method, std::span<double const> values,
                                     regression::Discovery& found);

}  // namespace sysid
