// The displacement of an oscillator under white noise: physics in the covariance.
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "expression/term.hpp"
#include "gaussian_process/rows.hpp"

namespace sysid::gaussian_process {
namespace oscillator_parts {

// `own` is the unit of force, [u_F]; input is time, output displacement.
constexpr HyperParameterRow hyper_parameters[] = {{"mass", false, {.output = -1, .input = 2, .own = 1}},
                                                  {"damping", false, {.output = -1, .input = 1, .own = 1}},
                                                  {"stiffness", false, {.output = -1, .own = 1}},
                                                  {"intensity", false, {.input = 1, .own = 2}}};

/// The free response over a time t >= 0, with a = damping/(2 mass), w^2 = stiffness/mass, delta = w^2 - a^2:
///   c = exp(-a t) cos(sqrt(delta) t),   s = exp(-a t) sin(sqrt(delta) t)/sqrt(delta),   d = ds/d(delta) = (t c - s)/(2 delta),
/// with cosh and sinh of sqrt(-delta) where delta < 0. All three are smooth where damping is critical; there a series stands for
/// them.
struct Response {
  double c, s, d;
};

Response response(double a, double frequency_squared, double t) {
  double const delta = frequency_squared - a * a, x = delta * t * t;
  if (std::fabs(x) < 0.5) {
    // c = sum of (-x)^n/(2n)!, s = t sum of (-x)^n/(2n+1)!, d = -t^3 sum of (-x)^(n-1) n/(2n+1)!; the last term left out is below
    // 1e-18.
    double c = 1, s = 1, d = 0, power = 1;  // (-x)^(n-1)/(2n-2)! at the top of the loop
    for (int n = 1; n < 9; ++n) {
      double const odd = power / ((2 * n - 1) * (2 * n)), next = odd / (2 * n + 1);  // (-x)^(n-1)/(2n)! and /(2n+1)!
      d -= n * next;
      power = -x * odd;
      c += power;
      s -= x * next;
    }
    double const decay = elementary::exp(-a * t);
    return {decay * c, decay * t * s, decay * t * t * t * d};
  }
  double c, s;
  if (delta > 0) {
    double const frequency = std::sqrt(delta), decay = elementary::exp(-a * t);
    c = decay * elementary::cos(frequency * t);
    s = decay * elementary::sin(frequency * t) / frequency;
  } else {
    double const rate = std::sqrt(-delta);  // a - rate without cancellation
    double const slow = elementary::exp(-frequency_squared / (a + rate) * t), fast = elementary::exp(-(a + rate) * t);
    c = 0.5 * (slow + fast);
    s = 0.5 * (slow - fast) / rate;
  }
  return {c, s, (t * c - s) / (2 * delta)};
}

struct Oscillator {
  double a, frequency_squared, variance;
  explicit Oscillator(Numbers p) : a(p[1] / (2 * p[0])), frequency_squared(p[2] / p[0]), variance(p[3] / (2 * p[1] * p[2])) {}
};

/// Stationary covariance of y in  mass y'' + damping y' + stiffness y = w,  E[w(t) w(t')] = intensity delta(t - t'):
///
///   k(t) = intensity/(2 damping stiffness) exp(-a |t|) (cos b |t| + a/b sin b |t|),   a = damping/(2 mass),   b^2 = stiffness/mass
///   - a^2
///
/// and its continuation for b^2 <= 0.                                                      Roberts & Spanos 2003, eq. 4.72; Caughey
/// 1971 Of displacements alone only three of the four can be told: mass, or another, must be known.
void values(Strip const& strip, Numbers p, double* out) {
  Oscillator const oscillator(p);
  for (int i = 0; i < strip.size; ++i) {
    Response const free = response(oscillator.a, oscillator.frequency_squared, std::fabs(strip.left[0][i] - strip.right[0]));
    out[i] = oscillator.variance * (free.c + oscillator.a * free.s);
  }
}

void add_gradient(Strip const& strip, Numbers p, double const* k, double const* weights, double* gradient) {
  Oscillator const oscillator(p);
  double const a = oscillator.a;
  double sum = 0, by_a = 0, by_square = 0;  // of the shape rho = c + a s, in a and in w^2
  for (int i = 0; i < strip.size; ++i) {
    double const t = std::fabs(strip.left[0][i] - strip.right[0]);
    Response const free = response(a, oscillator.frequency_squared, t);
    double const by_delta = -0.5 * t * free.s + a * free.d;
    sum += weights[i] * k[i];
    by_square += weights[i] * by_delta;
    by_a += weights[i] * (free.s - t * (free.c + a * free.s) - 2 * a * by_delta);
  }
  by_a *= oscillator.variance * a;
  by_square *= oscillator.variance * oscillator.frequency_squared;
  gradient[0] -= by_a + by_square;
  gradient[1] += by_a - sum;
  gradient[2] += by_square - sum;
  gradient[3] += sum;
}

/// As `values`, on numbers that carry derivatives: the same free response, its series where damping is nearly critical.
Jet jet(Jets left, Jets right, Jets p) {
  Jet const lag = left[0] - right[0], t = lag.value() < 0 ? 0.0 - lag : lag;
  Jet const a = p[1] / (2.0 * p[0]), square = p[2] / p[0], variance = p[3] / (2.0 * p[1] * p[2]);
  Jet const delta = square - a * a, x = delta * t * t;
  if (std::fabs(x.value()) < 0.5) {
    Jet c = 1.0, s = 1.0, power = 1.0;
    for (int n = 1; n < 10; ++n) {
      power = power * x * (-1.0 / ((2 * n - 1) * (2 * n)));
      c = c + power;
      s = s + power / (2.0 * n + 1);
    }
    return variance * exp(0.0 - a * t) * (c + a * t * s);
  }
  if (delta.value() > 0) {
    Jet const frequency = sqrt(delta);
    return variance * exp(0.0 - a * t) * (cos(frequency * t) + a * sin(frequency * t) / frequency);
  }
  Jet const rate = sqrt(0.0 - delta), slow = exp(0.0 - square / (a + rate) * t), fast = exp(0.0 - (a + rate) * t);
  return variance * 0.5 * (slow + fast + a * (slow - fast) / rate);
}

// States y, y': A = [c + a s, s; -w^2 s, c - a s], P = diag(intensity/(2 damping stiffness), intensity/(2 damping mass)).
void stationary(Numbers p, double* covariance, double* derivatives) {
  double const displacement = p[3] / (2 * p[1] * p[2]), velocity = p[3] / (2 * p[1] * p[0]);
  double const powers[4][2] = {{0, -1}, {-1, -1}, {-1, 0}, {1, 1}};  // of the two variances in each parameter
  covariance[0] = displacement, covariance[3] = velocity, covariance[1] = covariance[2] = 0;
  for (int j = 0; j < 4; ++j) {
    derivatives[4 * j] = powers[j][0] * displacement;
    derivatives[4 * j + 3] = powers[j][1] * velocity;
    derivatives[4 * j + 1] = derivatives[4 * j + 2] = 0;
  }
}

void transition(Numbers p, double step, double* out, double* derivatives) {
  Oscillator const oscillator(p);
  double const a = oscillator.a, square = oscillator.frequency_squared;
  Response const free = response(a, square, step);
  out[0] = free.c + a * free.s, out[2] = free.s;
  out[1] = -square * free.s, out[3] = free.c - a * free.s;
  if (derivatives == nullptr) return;
  // Derivatives of c and s in delta, then in a and w^2: d/da = -step - 2 a d/d(delta), since exp(-a step) is a factor of both.
  double const c_delta = -0.5 * step * free.s, s_delta = free.d;
  double const c_a = -step * free.c - 2 * a * c_delta, s_a = -step * free.s - 2 * a * s_delta;
  double const by_a[4] = {c_a + free.s + a * s_a, -square * s_a, s_a, c_a - free.s - a * s_a};
  double const by_square[4] = {c_delta + a * s_delta, -free.s - square * s_delta, s_delta, c_delta - a * s_delta};
  for (int i = 0; i < 4; ++i) {
    derivatives[i] = -a * by_a[i] - square * by_square[i];
    derivatives[4 + i] = a * by_a[i];
    derivatives[8 + i] = square * by_square[i];
    derivatives[12 + i] = 0;
  }
}

constexpr StateSpaceRow state_space{2, &stationary, &transition};

///   S = intensity/((stiffness - mass w^2)^2 + (damping w)^2)
NodeId spectral_root(Graph& graph, std::span<NodeId const> p, Numbers frequencies) {
  double const w = frequencies[0];
  Term const imaginary = w * Term(graph, p[1]), real = Term(graph, p[2]) - w * w * Term(graph, p[0]);
  Term const damped = imaginary * imaginary;
  return sqrt(Term(graph, p[3]) / (real * real + damped)).id;
}

}  // namespace oscillator_parts

KernelRow oscillator_kernel() {
  using namespace oscillator_parts;
  return {.name = "oscillator",
          .hyper_parameters = hyper_parameters,
          .one_input = true,
          .values = &values,
          .add_gradient = &add_gradient,
          .jet = &jet,
          .state_space = &state_space,
          .spectral_root = &spectral_root,
          .summary = "the displacement of mass, damper and spring under white noise"};
}

}  // namespace sysid::gaussian_process
