// The periodic kernel: functions that repeat themselves.
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {
namespace periodic_parts {

constexpr HyperParameterRow hyper_parameters[] = {
    {"amplitude", false, {.output = 1}}, {"length", true, {}}, {"period", true, {.input = 1}}};

///   k = amplitude^2 exp(-2 sum over d of sin^2(pi (x_d - x'_d)/period_d)/length_d^2)            Rasmussen & Williams 2006,
///   eq. 4.31
///
/// amplitude: unit of the function; length_d: a pure number, how smooth one period is; period_d: of input d.
void values(Strip const& strip, Numbers p, double* out) {
  int const inputs = static_cast<int>(strip.left.size());
  double angle[strip_size];
  for (int i = 0; i < strip.size; ++i) out[i] = 0;
  for (int d = 0; d < inputs; ++d) {
    double const length = p[1 + d], rate = std::numbers::pi / p[1 + inputs + d], weight = -2 / (length * length);
    for (int i = 0; i < strip.size; ++i) angle[i] = (strip.left[d][i] - strip.right[d]) * rate;
    elementary::sin_lanes(angle, angle, strip.size);
    for (int i = 0; i < strip.size; ++i) out[i] += weight * (angle[i] * angle[i]);
  }
  elementary::exp_lanes(out, out, strip.size);
  for (int i = 0; i < strip.size; ++i) out[i] *= p[0] * p[0];
}

void add_gradient(Strip const& strip, Numbers p, double const* k, double const* weights, double* gradient) {
  int const inputs = static_cast<int>(strip.left.size());
  double weighted[strip_size], angle[strip_size], sine[strip_size], cosine[strip_size];
  double sum = 0;
  for (int i = 0; i < strip.size; ++i) {
    weighted[i] = weights[i] * k[i];
    sum += weighted[i];
  }
  gradient[0] += 2 * sum;
  for (int d = 0; d < inputs; ++d) {
    double const length = p[1 + d], rate = std::numbers::pi / p[1 + inputs + d], scale = 4 / (length * length);
    for (int i = 0; i < strip.size; ++i) angle[i] = (strip.left[d][i] - strip.right[d]) * rate;
    elementary::sin_lanes(angle, sine, strip.size);
    elementary::cos_lanes(angle, cosine, strip.size);
    double by_length = 0, by_period = 0;
    for (int i = 0; i < strip.size; ++i) {
      by_length += weighted[i] * (sine[i] * sine[i]);
      by_period += weighted[i] * (sine[i] * cosine[i] * angle[i]);
    }
    gradient[1 + d] += scale * by_length;
    gradient[1 + inputs + d] += scale * by_period;
  }
}

Jet jet(Jets left, Jets right, Jets p) {
  std::size_t const inputs = left.size();
  Jet sum;
  for (std::size_t d = 0; d < inputs; ++d) {
    Jet const s = sin(std::numbers::pi * (left[d] - right[d]) / p[1 + inputs + d]) / p[1 + d];
    sum = sum + s * s;
  }
  return p[0] * p[0] * exp(-2.0 * sum);
}

}  // namespace periodic_parts

KernelRow periodic_kernel() {
  using namespace periodic_parts;
  return {.name = "periodic",
          .hyper_parameters = hyper_parameters,
          .values = &values,
          .add_gradient = &add_gradient,
          .jet = &jet,
          .summary = "periodic functions; multiplied by another kernel, functions that change slowly from period to period"};
}

}  // namespace sysid::gaussian_process
