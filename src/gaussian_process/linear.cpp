// The linear kernel: a line through the origin with an unknown slope for each input.
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {
namespace linear_parts {

constexpr HyperParameterRow hyper_parameters[] = {{"slope", true, {.output = 1, .input = -1}}};

///   k = sum over d of slope_d^2 x_d x'_d                                                   Rasmussen & Williams 2006, sec. 4.2.2
///
/// The same as coefficients with independent normal priors of mean 0 and sd slope_d, unit of the function over that of input d. A
/// line that misses the origin is this plus `constant`.
void values(Strip const& strip, Numbers p, double* out) {
  for (int i = 0; i < strip.size; ++i) out[i] = 0;
  for (std::size_t d = 0; d < p.size(); ++d) {
    double const factor = p[d] * p[d] * strip.right[d];
    for (int i = 0; i < strip.size; ++i) out[i] += factor * strip.left[d][i];
  }
}

void add_gradient(Strip const& strip, Numbers p, double const*, double const* weights, double* gradient) {
  for (std::size_t d = 0; d < p.size(); ++d) {
    double sum = 0;
    for (int i = 0; i < strip.size; ++i) sum += weights[i] * strip.left[d][i];
    gradient[d] += 2 * p[d] * p[d] * strip.right[d] * sum;
  }
}

Jet jet(Jets left, Jets right, Jets p) {
  Jet sum;
  for (std::size_t d = 0; d < p.size(); ++d) sum = sum + p[d] * p[d] * left[d] * right[d];
  return sum;
}

std::vector<NodeId> features(Graph& graph, std::span<NodeId const> p, std::span<NodeId const> inputs) {
  std::vector<NodeId> result;
  for (std::size_t d = 0; d < p.size(); ++d) result.push_back(graph.multiply(p[d], inputs[d]));
  return result;
}

}  // namespace linear_parts

KernelRow linear_kernel() {
  using namespace linear_parts;
  return {.name = "linear",
          .hyper_parameters = hyper_parameters,
          .values = &values,
          .add_gradient = &add_gradient,
          .jet = &jet,
          .features = &features,
          .summary = "lines through the origin with unknown slopes"};
}

}  // namespace sysid::gaussian_process
