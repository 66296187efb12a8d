// Parameters inside the terms of a dictionary, as K in `x^2/(K + x^2)`: their priors, and the dictionary at values of them.
#pragma once
#include <limits>
#include <span>
#include <vector>

#include "distribution/distribution.hpp"
#include "model/quantity.hpp"
#include "regression/column/dictionary.hpp"

namespace sysid {

/// Arguments and bounds of the prior are coherent SI.
struct InnerParameter {
  Quantity quantity;
  NodeId leaf = 0;
  DistributionRow const* prior = nullptr;
  std::vector<double> arguments;
  double lower = -std::numeric_limits<double>::infinity(), upper = std::numeric_limits<double>::infinity();
};

/// Of the prior; -infinity outside its support.
double log_density(InnerParameter const& parameter, double value);

/// Draws from the prior, in ascending order; the same each time. Throws UserError where the prior admits none.
std::vector<double> sorted_draws(InnerParameter const& parameter, int count);

/// Terms of equations with these parameters as leaves: [equation][term], nodes of the dictionary's graph.
using OpenTerms = std::vector<std::vector<NodeId>>;

/// The dictionary with numbers for these parameters, coherent SI.
regression::Dictionary with_inner(regression::Dictionary dictionary, OpenTerms const& open,
                                  std::span<InnerParameter const> parameters, std::span<double const> values);

}  // namespace sysid
