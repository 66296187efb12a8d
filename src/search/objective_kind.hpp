// The density whose optimum is searched for.
#pragma once

namespace sysid {

enum class ObjectiveKind {
  posterior,           // density on R^P, Jacobian included: what chains sample, so what their modes and masses are about
  declared_posterior,  // density of the declared parameters: `map`
  likelihood,          // `ml`
};

}  // namespace sysid
