// The constant kernel: an unknown constant.
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {
namespace constant_parts {

constexpr HyperParameterRow hyper_parameters[] = {{"amplitude", false, {.output = 1}}};

///   k = amplitude^2: a level with a normal prior of mean 0 and this sd.                     Rasmussen & Williams 2006, table 4.1
void values(Strip const& strip, Numbers p, double* out) {
  for (int i = 0; i < strip.size; ++i) out[i] = p[0] * p[0];
}

void add_gradient(Strip const& strip, Numbers, double const* k, double const* weights, double* gradient) {
  for (int i = 0; i < strip.size; ++i) gradient[0] += 2 * weights[i] * k[i];
}

Jet jet(Jets, Jets, Jets p) { return p[0] * p[0]; }

void stationary(Numbers p, double* covariance, double* derivatives) {
  covariance[0] = p[0] * p[0];
  derivatives[0] = 2 * covariance[0];
}

void transition(Numbers, double, double* transition, double* derivatives) {
  transition[0] = 1;
  if (derivatives != nullptr) derivatives[0] = 0;
}

std::vector<NodeId> features(Graph&, std::span<NodeId const> p, std::span<NodeId const>) { return {p[0]}; }

constexpr StateSpaceRow state_space{1, &stationary, &transition};

}  // namespace constant_parts

KernelRow constant_kernel() {
  using namespace constant_parts;
  return {.name = "constant",
          .hyper_parameters = hyper_parameters,
          .values = &values,
          .add_gradient = &add_gradient,
          .jet = &jet,
          .state_space = &state_space,
          .features = &features,
          .summary = "an unknown constant"};
}

}  // namespace sysid::gaussian_process
