// Settings by name to a plan.
#include "inference/abc/plan.hpp"

#include <limits>

#include "core/text/diagnostic.hpp"
#include "inference/abc/kernel.hpp"

namespace sysid::abc {
Plan plan_of(Settings const& s) {
  Plan plan;
  plan.particles = static_cast<int>(s.integer("particles"));
  plan.quantile = s.real("quantile");
  plan.schedule = s.numbers("schedule");
  plan.first_threshold = s.real("first_threshold") > 0 ? s.real("first_threshold") : std::numeric_limits<double>::infinity();
  plan.kernel = find_kernel(s.word("kernel"));
  if (plan.kernel == nullptr) throw InternalError("there is no kernel `" + s.word("kernel") + "`");
  plan.scale = s.real("kernel_scale") > 0 ? s.real("kernel_scale") : plan.kernel->scale;
  plan.neighbours = static_cast<int>(s.integer("neighbours"));
  std::string const& coordinates = s.word("coordinates");
  plan.coordinates = coordinates == "declared"        ? Coordinates::declared
                     : coordinates == "unconstrained" ? Coordinates::unconstrained
                                                      : Coordinates::natural;
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
