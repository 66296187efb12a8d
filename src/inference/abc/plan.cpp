// Settings by name to a plan.
#include "inference/abc/plan.hpp"

#include <limits>

#include "core/diagnostic.hpp"

namespace sysid::abc {
namespace {

KernelKind kernel_of(std::string const& word) {
  if (word == "gaussian") return KernelKind::gaussian;
  if (word == "component_gaussian") return KernelKind::component_gaussian;
  if (word == "uniform") return KernelKind::uniform;
  if (word == "nearest_neighbours") return KernelKind::nearest_neighbours;
  throw InternalError("there is no kernel `" + word + "`");
}

/// The kernel's own scale. gaussian, component_gaussian: twice the weighted covariance is the optimum of Filippi et al. 2013 for a
/// population that changes slowly; uniform: as wide as the last population's range; nearest_neighbours: the local covariance.
double own_scale(KernelKind kernel) { return kernel == KernelKind::gaussian || kernel == KernelKind::component_gaussian ? 2 : 1; }

}  // namespace

Plan plan_of(Settings const& s) {
  Plan plan;
  plan.particles = static_cast<int>(s.integer("particles"));
  plan.quantile = s.real("quantile");
  plan.schedule = s.numbers("schedule");
  plan.first_threshold = s.real("first_threshold") > 0 ? s.real("first_threshold") : std::numeric_limits<double>::infinity();
  plan.kernel = kernel_of(s.word("kernel"));
  plan.scale = s.real("kernel_scale") > 0 ? s.real("kernel_scale") : own_scale(plan.kernel);
  plan.neighbours = static_cast<int>(s.integer("neighbours"));
  plan.declared = s.word("coordinates") == "declared";
  plan.from_previous = s.word("model_kernel") == "previous";
  plan.stay = s.real("stay");
  plan.threshold_change = s.real("threshold_change");
  plan.relative_change = s.real("relative_change");
  plan.target = s.real("target");
  plan.acceptance = s.real("acceptance");
  plan.simulations = static_cast<std::uint64_t>(s.real("simulations"));
  plan.wall_time = s.real("wall_time");
  plan.populations = static_cast<int>(s.integer("populations"));
  return plan;
}

}  // namespace sysid::abc
