// The checked model as text, for `--dump model`: the first-order system, priors, channels and derived quantities after checking.
#pragma once
#include <string>

#include "model/model.hpp"

namespace sysid {

std::string dump(Model const& model);

/// The user's name of a leaf of the model's graph.
std::string leaf_name(Model const& model, Node const& leaf);

}  // namespace sysid
