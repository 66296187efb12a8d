// The simulated motion from each sample to the next, to first order: what a push of a state, or another value of an input, does to
// it.
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vector>

#include "discovery/search/whole_dictionary.hpp"

namespace sysid {

/// Of one record with N rows, d states and u inputs of the model:
///
///   move of x(n+1) = ahead(n) * move of x(n) + here(n) * change of u(n) + next(n) * change of u(n+1)
struct SampleSteps {
  std::vector<Eigen::VectorXd> states;      // [N], as simulated
  std::vector<Eigen::MatrixXd> ahead;       // [N - 1], [d x d]
  std::vector<Eigen::MatrixXd> here, next;  // [N - 1], [d x u]; empty where inputs were not asked for
};

/// Of each record along a fit, whether or not its states are measured. Nothing where the simulation is not finite.
std::optional<std::vector<SampleSteps>> sample_steps(WholeDictionary const& dictionary, FittedTerms const& fitted,
                                                     FitConditions const& conditions, bool inputs);

}  // namespace sysid
