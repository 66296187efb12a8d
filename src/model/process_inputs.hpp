// Gaussian processes as inputs: for whoever draws their values and simulates with them.
#pragma once
#include "model/model.hpp"

namespace sysid {

/// Every process becomes an input behind the model's own, in their order, and its arguments the model's derived quantities, process
/// after process; those that there were are gone.
void processes_as_inputs(Model& model);

}  // namespace sysid
