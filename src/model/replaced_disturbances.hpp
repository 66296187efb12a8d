// A model whose disturbances have become something else: states, inputs, parameters.
#pragma once
#include <span>

#include "model/model.hpp"

namespace sysid {

/// Wherever the model reads one, what stands at its index takes its place; it has no disturbances then.
void replace_disturbances(Model& model, std::span<NodeId const> by);

}  // namespace sysid
