// Where equations read an input.
#pragma once
#include <vector>

#include "model/model.hpp"

namespace sysid {

/// The leaves by which the equations and the noise of a model read an input: its samples, at each of their lags, and its rate.
std::vector<Node> leaves_of_input(Model const& model, int input);

}  // namespace sysid
