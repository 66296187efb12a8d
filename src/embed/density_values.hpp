// The log density of a fit for batches of parameter vectors, as programs that have the engine in them ask for it.
#pragma once
#include <vector>

#include "core/numeric/lanes.hpp"
#include "core/system/ledger.hpp"
#include "likelihood/target.hpp"

namespace sysid::embed {

enum class Part { prior, likelihood, both };

/// Of theta [P x W], unconstrained coordinates: the density on R^P, [W]. -infinity where a solve failed, and where a coordinate is
/// not finite; never NaN.
std::vector<double> log_density(Target const& target, ConstLanes theta, Part part, Ledger& ledger);

/// Of values [P x W] in declared units: the density of the values. -infinity outside the support of a prior. At a bound of a
/// support it is the limit of the prior from within, which may be -infinity or +infinity, times the likelihood.
std::vector<double> declared_log_density(Target const& target, ConstLanes values, Part part, Ledger& ledger);

struct ValueAndGradient {
  std::vector<double> value;  // [W]
  LaneArray gradient;         // [P x W], NaN where the value is -infinity
};
/// Of prior times likelihood at theta [P x W], and its derivatives by theta.
ValueAndGradient log_density_with_gradient(Target const& target, ConstLanes theta, Ledger& ledger);

struct ResidualsAndJacobian {
  LaneArray residuals;  // [R x W], infinity where a solve failed
  LaneArray jacobian;   // [R*P x W], NaN where a residual is not finite
};
/// Residuals at theta [P x W], and their derivatives by theta.
ResidualsAndJacobian residuals_with_jacobian(Target const& target, ConstLanes theta, Ledger& ledger);

}  // namespace sysid::embed
