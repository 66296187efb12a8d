// Numbers that carry derivatives: in a coordinate of a kernel's left point, in one of its right point, and in the logarithm of one
// hyper-parameter.
#pragma once
#include <array>
#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid::gaussian_process {

/// A value and all mixed derivatives that are of first order in each of three quantities, as coefficients of a polynomial in three
/// numbers whose squares are zero.                                                      Fike & Alonso 2011, hyper-dual numbers
struct Jet {
  static constexpr unsigned left = 1, right = 2, parameter = 4;
  /// By the set of quantities that it is derived in; part[0] is the value.
  std::array<double, 8> part{};

  Jet(double value = 0) : part{value} {}
  /// A quantity itself; change: the derivative in what moves it.
  Jet(double value, unsigned quantity, double change) : part{value} { part[quantity] = change; }
  double value() const { return part[0]; }
};

inline Jet operator+(Jet a, Jet const& b) {
  for (unsigned s = 0; s < 8; ++s) a.part[s] += b.part[s];
  return a;
}
inline Jet operator-(Jet a, Jet const& b) {
  for (unsigned s = 0; s < 8; ++s) a.part[s] -= b.part[s];
  return a;
}
inline Jet operator*(Jet const& a, Jet const& b) {
  Jet result;
  for (unsigned s = 0; s < 8; ++s)
    for (unsigned t = s;; t = (t - 1) & s) {  // the subsets of s
      result.part[s] += a.part[t] * b.part[s ^ t];
      if (t == 0) break;
    }
  return result;
}

/// f(a) from f and its first three derivatives at the value of a.
inline Jet compose(Jet const& a, double f, double first, double second, double third) {
  Jet moved = a;
  moved.part[0] = 0;
  Jet const square = moved * moved, cube = square * moved;
  Jet result(f);
  for (unsigned s = 1; s < 8; ++s) result.part[s] = first * moved.part[s] + second / 2 * square.part[s] + third / 6 * cube.part[s];
  return result;
}

inline Jet operator/(Jet const& a, Jet const& b) {
  double const inverse = 1 / b.value(), square = inverse * inverse;
  return a * compose(b, inverse, -square, 2 * square * inverse, -6 * square * square);
}
inline Jet exp(Jet const& a) {
  double const e = elementary::exp(a.value());
  return compose(a, e, e, e, e);
}
inline Jet sin(Jet const& a) {
  double const s = elementary::sin(a.value()), c = elementary::cos(a.value());
  return compose(a, s, c, -s, -c);
}
inline Jet cos(Jet const& a) {
  double const s = elementary::sin(a.value()), c = elementary::cos(a.value());
  return compose(a, c, -s, -c, s);
}
/// Of a positive number.
inline Jet sqrt(Jet const& a) {
  double const x = a.value(), root = std::sqrt(x);
  return compose(a, root, 0.5 / root, -0.25 / (root * x), 0.375 / (root * x * x));
}

}  // namespace sysid::gaussian_process
