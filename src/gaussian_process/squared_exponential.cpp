// The squared exponential kernel: functions with all derivatives.
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "function/primitive.hpp"
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {
namespace squared_exponential_parts {

///   k = amplitude^2 exp(-r^2/2),   r^2 = sum over d of ((x_d - x'_d)/length_d)^2          Rasmussen & Williams 2006, eq. 4.9, 5.1
///
/// amplitude: unit of the function; length_d: of input d.
void values(Strip const& strip, Numbers p, double* out) {
  squared_distances(strip, p.subspan(1), out);
  for (int i = 0; i < strip.size; ++i) out[i] *= -0.5;
  elementary::exp_lanes(out, out, strip.size);
  double const variance = p[0] * p[0];
  for (int i = 0; i < strip.size; ++i) out[i] *= variance;
}

void add_gradient(Strip const& strip, Numbers p, double const* k, double const* weights, double* gradient) {
  double weighted[strip_size];
  double sum = 0;
  for (int i = 0; i < strip.size; ++i) {
    weighted[i] = weights[i] * k[i];
    sum += weighted[i];
  }
  gradient[0] += 2 * sum;
  add_length_gradient(strip, p.subspan(1), weighted, gradient + 1);
}

Jet jet(Jets left, Jets right, Jets p) { return p[0] * p[0] * exp(-0.5 * squared_distance(left, right, p.subspan(1))); }

///   S = amplitude^2 (2 pi)^(D/2) (product of lengths) exp(-1/2 sum of (length_d w_d)^2)      Rasmussen & Williams 2006, eq. 4.11
NodeId spectral_root(Graph& graph, std::span<NodeId const> p, Numbers frequencies) {
  Term root(graph, p[0]), exponent(graph, 0.0);
  for (std::size_t d = 0; d < frequencies.size(); ++d) {
    Term const length(graph, p[1 + d]), product = frequencies[d] * length;
    root = root * sqrt(std::sqrt(2 * std::numbers::pi) * length);
    exponent = exponent + product * product;
  }
  return (root * exp(-0.25 * exponent)).id;
}

}  // namespace squared_exponential_parts

KernelRow squared_exponential_kernel() {
  using namespace squared_exponential_parts;
  return {.name = "squared_exponential",
          .hyper_parameters = amplitude_and_lengths,
          .values = &values,
          .add_gradient = &add_gradient,
          .jet = &jet,
          .spectral_root = &spectral_root,
          .summary = "smooth functions, with all derivatives"};
}

}  // namespace sysid::gaussian_process
