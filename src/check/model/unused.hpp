// What a model declares and never uses.
#pragma once
#include <span>

#include "core/text/diagnostic.hpp"
#include "model/model.hpp"

namespace sysid {

/// Warns (E3019) of parameters and inputs that neither the equations nor what starts, observes or derives from them reads, directly
/// or through the priors of parameters that they read: a posterior equal to the prior, a column that changes nothing.
/// Of models that differ in arguments alone, one that reads it is enough.
void warn_of_unused(std::span<Model const> models, Diagnostics& diagnostics);

/// The same of disturbances, as an error (E3308): they make a filter of the likelihood.
void refuse_unused_disturbances(std::span<Model const> models, Diagnostics& diagnostics);

}  // namespace sysid
