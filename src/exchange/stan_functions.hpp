// The functions of a Stan program: equations, densities, the integrator, prior and likelihood.
#pragma once
#include "exchange/stan_columns.hpp"
#include "exchange/stan_fit.hpp"

namespace sysid {

/// The block `functions`. Functions of the model take its states y, a row d of the data and its parameters p, SI; `columns` gets
/// what they read. UserError for functions that Stan does not have and bounds that depend on parameters.
std::string stan_functions_block(StanFit const& fit, StanColumns& columns);

/// The names of these functions and of what they share with the other blocks, which parameters cannot have.
std::vector<std::string> stan_function_names(StanFit const& fit);

}  // namespace sysid
