// The Matérn kernels 1/2, 3/2 and 5/2: functions with none, one and two derivatives.
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"
#include "expression/term.hpp"
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {
namespace matern_parts {

///   k = amplitude^2 q(z) exp(-z),   z = sqrt(2 nu) r,   r^2 = sum over d of ((x_d - x'_d)/length_d)^2,
///   q = 1,   1 + z,   1 + z + z^2/3   for nu = 1/2, 3/2, 5/2                               Rasmussen & Williams 2006, eq. 4.17
///
/// amplitude: unit of the function; length_d: of input d. TwiceNu: 2 nu.
template <int TwiceNu>
double polynomial(double z) {
  if constexpr (TwiceNu == 1) return 1;
  if constexpr (TwiceNu == 3) return 1 + z;
  return 1 + z + z * z / 3;
}

/// -(dk/dr)/r = (2 nu) slope(z) amplitude^2 exp(-z); at r = 0, where 1/2 has a corner, it is multiplied by r^2 = 0 and may be
/// anything.
template <int TwiceNu>
double slope(double z) {
  if constexpr (TwiceNu == 1) return z > 0 ? 1 / z : 0;
  if constexpr (TwiceNu == 3) return 1;
  return (1 + z) / 3;
}

template <int TwiceNu>
void values(Strip const& strip, Numbers p, double* out) {
  double z[strip_size];
  squared_distances(strip, p.subspan(1), z);
  for (int i = 0; i < strip.size; ++i) {
    z[i] = std::sqrt(TwiceNu * z[i]);
    out[i] = -z[i];
  }
  elementary::exp_lanes(out, out, strip.size);
  double const variance = p[0] * p[0];
  for (int i = 0; i < strip.size; ++i) out[i] *= variance * polynomial<TwiceNu>(z[i]);
}

template <int TwiceNu>
void add_gradient(Strip const& strip, Numbers p, double const* k, double const* weights, double* gradient) {
  double weighted[strip_size];
  squared_distances(strip, p.subspan(1), weighted);
  double sum = 0;
  for (int i = 0; i < strip.size; ++i) {
    double const z = std::sqrt(TwiceNu * weighted[i]), one = weights[i] * k[i];
    sum += one;
    weighted[i] = one * TwiceNu * slope<TwiceNu>(z) / polynomial<TwiceNu>(z);
  }
  gradient[0] += 2 * sum;
  add_length_gradient(strip, p.subspan(1), weighted, gradient + 1);
}

/// As a function of s = r^2, with z = sqrt((2 nu) s) and d/ds = nu/z d/dz. What grows without bound as z goes to 0 multiplies
/// derivatives of s that vanish faster there; of 1/2 the derivative in both points does not exist, and is never asked for.
template <int TwiceNu>
Jet jet(Jets left, Jets right, Jets p) {
  Jet const square = squared_distance(left, right, p.subspan(1));
  double const z = std::sqrt(TwiceNu * square.value()), decay = elementary::exp(-z);
  double const inverse = z > 1e-30 ? 1 / z : 0;  // below, two points are one
  double first = 0, second = 0, third = 0;
  if constexpr (TwiceNu == 1) {
    first = -0.5 * inverse;
  } else if constexpr (TwiceNu == 3) {
    first = -1.5;
    second = 2.25 * inverse;
    third = -3.375 * inverse * inverse * (1 + inverse);
  } else {
    first = -5. / 6 * (1 + z);
    second = 25. / 12;
    third = -125. / 24 * inverse;
  }
  return p[0] * p[0] * compose(square, polynomial<TwiceNu>(z) * decay, first * decay, second * decay, third * decay);
}

///   S = amplitude^2 2^D pi^(D/2) Gamma(nu + D/2)/Gamma(nu) (2 nu)^nu (2 nu + |w|^2)^-(nu + D/2) (product of lengths),
///   w_d = length_d frequency_d                                                             Rasmussen & Williams 2006, eq. 4.15
template <int TwiceNu>
NodeId spectral_root(Graph& graph, std::span<NodeId const> p, Numbers frequencies) {
  double const nu = 0.5 * TwiceNu, half = 0.5 * static_cast<double>(frequencies.size());
  Term root(graph, p[0]), square(graph, static_cast<double>(TwiceNu));
  for (std::size_t d = 0; d < frequencies.size(); ++d) {
    Term const length(graph, p[1 + d]), product = frequencies[d] * length;
    root = root * sqrt(2 * std::sqrt(std::numbers::pi) * length);
    square = square + product * product;
  }
  double const logarithm = elementary::lgamma(nu + half) - elementary::lgamma(nu) + nu * elementary::log(TwiceNu);
  Term const decay = pow(square, Term(graph, -0.5 * (nu + half)));
  return (elementary::exp(0.5 * logarithm) * root * decay).id;
}

// State-space form: states f, f'/lambda, f''/lambda^2, ... with lambda = sqrt(2 nu)/length. In these units P = amplitude^2 P0 and
// A = exp(-s) (I + s N + s^2 N^2/2), s = lambda step, where N = F/lambda + I and (D + lambda)^n f = white noise makes N nilpotent:
//
//   1/2: P0 = 1;   3/2: P0 = diag(1, 1), F/lambda = [0 1; -1 -2];   5/2: P0 = [1 0 -1/3; 0 1/3 0; -1/3 0 1],
//   F/lambda = [0 1 0; 0 0 1; -1 -3 -3]                                                    Särkkä & Solin 2019, sec. 12.3, ex. 12.7
//
// Scaled so, P does not depend on the length, and dA/dlog(length) = -s F/lambda A.
template <int D>
struct Form;
template <>
struct Form<1> {
  static constexpr double covariance[1] = {1}, drift[1] = {-1};
};
template <>
struct Form<2> {
  static constexpr double covariance[4] = {1, 0, 0, 1}, drift[4] = {0, -1, 1, -2};
};
template <>
struct Form<3> {
  static constexpr double covariance[9] = {1, 0, -1. / 3, 0, 1. / 3, 0, -1. / 3, 0, 1};
  static constexpr double drift[9] = {0, 0, -1, 1, 0, -3, 0, 1, -3};
};

template <int D>
void stationary(Numbers p, double* covariance, double* derivatives) {
  for (int i = 0; i < D * D; ++i) {
    covariance[i] = p[0] * p[0] * Form<D>::covariance[i];
    derivatives[i] = 2 * covariance[i];
    derivatives[D * D + i] = 0;
  }
}

/// out = left * right, D x D by columns.
template <int D>
void product(double const* left, double const* right, double* out) {
  for (int j = 0; j < D; ++j)
    for (int i = 0; i < D; ++i) {
      double sum = 0;
      for (int m = 0; m < D; ++m) sum += left[i + D * m] * right[m + D * j];
      out[i + D * j] = sum;
    }
}

template <int D>
void transition(Numbers p, double step, double* out, double* derivatives) {
  double const s = std::sqrt(2.0 * D - 1) / p[1] * step, decay = elementary::exp(-s);
  double nilpotent[D * D], power[D * D], next[D * D];
  for (int i = 0; i < D * D; ++i) {
    double const identity = i % (D + 1) == 0 ? 1 : 0;
    nilpotent[i] = Form<D>::drift[i] + identity;
    power[i] = decay * identity;
    out[i] = power[i];
  }
  for (int order = 1; order < D; ++order) {
    product<D>(nilpotent, power, next);
    for (int i = 0; i < D * D; ++i) {
      power[i] = next[i] * (s / order);
      out[i] += power[i];
    }
  }
  if (derivatives == nullptr) return;
  product<D>(Form<D>::drift, out, derivatives + D * D);
  for (int i = 0; i < D * D; ++i) {
    derivatives[i] = 0;
    derivatives[D * D + i] *= -s;
  }
}

template <int TwiceNu>
KernelRow row(std::string_view name, std::string_view summary) {
  constexpr int dimension = (TwiceNu + 1) / 2;
  static constexpr StateSpaceRow state_space{dimension, &stationary<dimension>, &transition<dimension>};
  return {.name = name,
          .hyper_parameters = amplitude_and_lengths,
          .values = &values<TwiceNu>,
          .add_gradient = &add_gradient<TwiceNu>,
          .jet = &jet<TwiceNu>,
          .differentiable = TwiceNu > 1,
          .state_space = &state_space,
          .spectral_root = &spectral_root<TwiceNu>,
          .summary = summary};
}

}  // namespace matern_parts

KernelRow matern12_kernel() {
  return matern_parts::row<1>("matern12",
                              "rough functions without a derivative: drifting levels, white noise after a first-order filter");
}
KernelRow matern32_kernel() { return matern_parts::row<3>("matern32", "functions with one derivative"); }
KernelRow matern52_kernel() { return matern_parts::row<5>("matern52", "functions with two derivatives, usual in mechanics"); }

}  // namespace sysid::gaussian_process
