// The worked example of a kernel in docs/extending.md, compiled and held to what the tests over the table ask of a row.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "core/numeric/elementary.hpp"
#include "gaussian_process/rows.hpp"
#include "relative.hpp"

namespace sysid::gaussian_process {
namespace rational_quadratic_parts {

constexpr HyperParameterRow hyper_parameters[] = {
    {"amplitude", false, {.output = 1}}, {"length", true, {.input = 1}}, {"shape", false, {}}};

///   k = amplitude^2 (1 + q)^-shape,   q = r^2/(2 shape),   r^2 = sum over d of ((x_d - x'_d)/length_d)^2
///                                                                                          Rasmussen & Williams 2006, eq. 4.19
/// amplitude: unit of the function; length_d: of input d; shape: a pure number, large for one length, small for many.
void values(Strip const& strip, Numbers p, double* out) {
  double const shape = p.back();
  squared_distances(strip, p.subspan(1, strip.left.size()), out);
  for (int i = 0; i < strip.size; ++i) out[i] = -shape * elementary::log1p(out[i] / (2 * shape));
  elementary::exp_lanes(out, out, strip.size);
  double const variance = p[0] * p[0];
  for (int i = 0; i < strip.size; ++i) out[i] *= variance;
}

/// dk/dlog amplitude = 2 k,   dk/dlog length_d = k r_d^2/(1 + q),   dk/dlog shape = k shape (q/(1 + q) - log(1 + q)).
void add_gradient(Strip const& strip, Numbers p, double const* k, double const* weights, double* gradient) {
  double const shape = p.back();
  double weighted[strip_size];
  squared_distances(strip, p.subspan(1, strip.left.size()), weighted);
  double of_amplitude = 0, of_shape = 0;
  for (int i = 0; i < strip.size; ++i) {
    double const q = weighted[i] / (2 * shape), one = weights[i] * k[i];
    of_amplitude += 2 * one;
    of_shape += one * shape * (q / (1 + q) - elementary::log1p(q));
    weighted[i] = one / (1 + q);
  }
  gradient[0] += of_amplitude;
  add_length_gradient(strip, p.subspan(1, strip.left.size()), weighted, gradient + 1);
  gradient[p.size() - 1] += of_shape;
}

Jet jet(Jets left, Jets right, Jets p) {
  Jet const shape = p.back(), base = 1 + squared_distance(left, right, p.subspan(1)) / (2 * shape);
  double const b = base.value();
  Jet const logarithm = compose(base, elementary::log(b), 1 / b, -1 / (b * b), 2 / (b * b * b));
  return p[0] * p[0] * exp(-1 * shape * logarithm);
}

}  // namespace rational_quadratic_parts

KernelRow rational_quadratic_kernel() {
  using namespace rational_quadratic_parts;
  return {.name = "rational_quadratic",
          .hyper_parameters = hyper_parameters,
          .values = &values,
          .add_gradient = &add_gradient,
          .jet = &jet,
          .summary = "smooth functions with many lengths at once"};
}

}  // namespace sysid::gaussian_process

using namespace sysid::gaussian_process;
using sysid::relative;

TEST_CASE("the example kernel has the gradient and the derivatives of its values") {
  KernelRow const row = rational_quadratic_kernel();
  double const first = 0.4, second = -1.2, right[] = {1.3, 0.2};
  double const* const left[] = {&first, &second};
  std::vector<double> parameters = {3, 2, 0.7, 1.5};  // amplitude, two lengths, shape
  auto const value = [&](std::vector<double> const& p) {
    double out = 0;
    row.values({left, right, 1}, p, &out);
    return out;
  };
  double const square = std::pow(0.9 / 2, 2) + std::pow(1.4 / 0.7, 2), weight = 1, k = value(parameters);
  CHECK(k == doctest::Approx(9 * std::pow(1 + square / 3, -1.5)).epsilon(1e-13));
  std::vector<double> gradient(4);
  row.add_gradient({left, right, 1}, parameters, &k, &weight, gradient.data());
  for (std::size_t i = 0; i < 4; ++i) {
    std::vector<double> above = parameters, below = parameters;
    above[i] *= std::exp(1e-4);
    below[i] *= std::exp(-1e-4);
    CHECK(gradient[i] == relative((value(above) - value(below)) / 2e-4, 1e-6));
    // The same from numbers that carry their derivatives.
    std::vector<Jet> jets(parameters.begin(), parameters.end());
    jets[i] = Jet(parameters[i], Jet::parameter, parameters[i]);
    Jet const points[] = {first, second}, others[] = {right[0], right[1]};
    Jet const result = row.jet(std::span(points), std::span(others), jets);
    CHECK(result.value() == doctest::Approx(k).epsilon(1e-13));
    CHECK(result.part[Jet::parameter] == relative(gradient[i], 1e-12));
  }
}
