// Draws of a model with Gaussian processes: coefficients that were integrated out, and trajectories.
#pragma once
#include <vector>

#include "likelihood/process/process_forecast.hpp"
#include "likelihood/process/process_target.hpp"
#include "result/draws.hpp"

namespace sysid {

/// Draws of all parameters in the user's order from those of target.model().reduced(): each coefficient is drawn from its normal
/// distribution given the rest of its draw, or is its mean where there is one draw only. all: the space of target.model().
Draws with_coefficients(ProcessTarget const& target, ParameterSpace const& all, Draws const& sampled, std::uint64_t seed);

/// Declared sds of the coefficients given everything else, by name; declared: values of all parameters.
std::vector<std::pair<std::string, double>> coefficient_sds(ProcessTarget const& target, ParameterSpace const& all,
                                                            std::vector<double> const& declared);

/// Parameters of the model [parameters x fitted experiments], SI, of one draw.
LaneArray fitted_parameters(ParameterSpace const& all, std::vector<double> const& declared);

/// About `wanted` trajectories from draws spread evenly; own: parameters of the experiment [parameters x draws], SI, for `spread`
/// of the draws.
Trajectory::Result forecast_draws(ProcessForecast const& forecast, ParameterSpace const& all, LaneArray const& spread,
                                  ConstLanes own, int wanted, StreamKey key);

}  // namespace sysid
