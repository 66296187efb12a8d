// The estimated unknown functions of the equations, and whether their finite sums are accurate.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "inference/backend/backend.hpp"
#include "likelihood/parameter_space.hpp"
#include "result/finding.hpp"
#include "result/function.hpp"

namespace sysid {

/// What is known of the parameters where functions are looked at.
struct FunctionParameters {
  LaneArray
      values;  // of the model [parameters x W], SI: draws; or an optimum, and behind it a move to either side in each coordinate
  Eigen::MatrixXd covariance;  // of these coordinates in units of the moves [D x D]; empty: they are draws
};
FunctionParameters function_parameters(ParameterSpace const& space, FitResult const& result);

/// Every unknown function over its range: mean and quantiles of draws; at an optimum its value there, and the width that Laplace's
/// approximation gives it to first order, in which an amplitude and the coefficients that it multiplies hold each other.
std::vector<FunctionReport> unknown_functions(Model const& model, FunctionParameters const& parameters);

/// basis_inaccurate where a sum, with the mean of the hyper-parameters, is not the process that it stands for.
Findings check_expansions(Model const& model, ConstLanes parameters);

}  // namespace sysid
