// Distribution functions that truncated densities need and SLEEF lacks: the incomplete gamma functions and Student's t, from
// Boost.Math. Exempt from equality across processors, by name: gamma_p, gamma_q, student_t_cdf (Boost calls the C library's exp and
// pow). On one processor they depend on their arguments alone, so lanes and threads change nothing.
#include "function/boost_policy.hpp"
#include "function/primitive.hpp"

#include <boost/math/special_functions/beta.hpp>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <numbers>

namespace sysid {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// P(a, x) = gamma(a, x) / Gamma(a), a > 0, x >= 0 (also infinite); NaN elsewhere. DLMF 8.2.4
double lower_gamma(double a, double x) {
  if (!(a > 0 && std::isfinite(a) && x >= 0)) return nan;
  return std::isinf(x) ? 1 : boost::math::gamma_p(a, x, BoostPolicy());
}

/// Q(a, x) = 1 - P(a, x), accurate where it is small.
double upper_gamma(double a, double x) {
  if (!(a > 0 && std::isfinite(a) && x >= 0)) return nan;
  return std::isinf(x) ? 0 : boost::math::gamma_q(a, x, BoostPolicy());
}

/// P(T <= t), n > 0 degrees of freedom: half of I_z(n/2, 1/2) with z = n/(n + t^2) below 0, reflected above.            DLMF 8.17.2
double student(double t, double n) {
  if (!(n > 0 && std::isfinite(n)) || std::isnan(t)) return nan;
  if (std::isinf(t)) return t < 0 ? 0 : 1;
  double const square = t * t;
  double const tail = square < n ? boost::math::ibetac(0.5, n / 2, square / (n + square), BoostPolicy()) / 2
                                 : boost::math::ibeta(n / 2, 0.5, 1 / (1 + square / n), BoostPolicy()) / 2;
  return t < 0 ? tail : 1 - tail;
}

/// No closed form exists for the derivative by the shape: a central difference over a relative step of 1e-5, good to 1e-9.
NodeId difference(Graph& graph, Function const& function, NodeId a, NodeId b, int which) {
  constexpr double step = 1e-5;
  Term const x(graph, a), y(graph, b);
  Term const high = which == 0 ? call(function, x * (1 + step), y) : call(function, x, y * (1 + step));
  Term const low = which == 0 ? call(function, x * (1 - step), y) : call(function, x, y * (1 - step));
  Term const width = (which == 0 ? x : y) * (2 * step);
  return ((high - low) / width).id;
}

/// d/dx P(a, x) = x^(a-1) e^-x / Gamma(a) DLMF 8.8.13
Term gamma_slope(Term a, Term x) {
  Term const of_a = lgamma(a), log_x = log(x);
  return exp((a - 1.0) * log_x - x - of_a);
}

NodeId gamma_p_derivative(Graph& graph, NodeId, NodeId a, NodeId b, int which) {
  if (which == 0) return difference(graph, gamma_p_function, a, b, 0);
  return gamma_slope(Term(graph, a), Term(graph, b)).id;
}

NodeId gamma_q_derivative(Graph& graph, NodeId, NodeId a, NodeId b, int which) {
  if (which == 0) return difference(graph, gamma_q_function, a, b, 0);
  return (-gamma_slope(Term(graph, a), Term(graph, b))).id;
}

NodeId student_t_cdf_derivative(Graph& graph, NodeId, NodeId a, NodeId b, int which) {
  if (which == 1) return difference(graph, student_t_cdf_function, a, b, 1);
  Term const t(graph, a), n(graph, b);
  Term const of_n = 0.5 * log(n * std::numbers::pi), lower = lgamma(n / 2.0), constant = lgamma((n + 1.0) / 2.0) - lower - of_n;
  Term const tail = log1p(t * t / n);
  return exp(constant - (n + 1.0) / 2.0 * tail).id;
}

}  // namespace

Function const gamma_p_function{"gamma_p", 2, nullptr, nullptr, &lower_gamma, &over_lanes<&lower_gamma>, &gamma_p_derivative};
Function const gamma_q_function{"gamma_q", 2, nullptr, nullptr, &upper_gamma, &over_lanes<&upper_gamma>, &gamma_q_derivative};
Function const student_t_cdf_function{"student_t_cdf",          2, nullptr, nullptr, &student, &over_lanes<&student>,
                                      &student_t_cdf_derivative};

}  // namespace sysid
