// Algorithm AS 241, PPND16: rational approximations.          Wichura 1988, Applied Statistics 37, 477
#include "core/numeric/normal_quantile.hpp"

#include <array>
#include <cmath>

#include "core/numeric/elementary.hpp"

namespace sysid {
namespace {

constexpr double central = 0.425;  // |probability - 1/2| up to which the central approximation holds

struct Ratio {
  double above, below;
};

/// Two polynomials of degree 7 by Horner's rule, coefficients from the constant one on.
Ratio ratio(double r, std::array<double, 8> const& a, std::array<double, 8> const& b) {
  Ratio result{a[7], b[7]};
  for (std::size_t i = 7; i-- > 0;) {
    result.above = result.above * r + a[i];
    result.below = result.below * r + b[i];
  }
  return result;
}

/// z / q for |q| <= `central`. last: the denominator's coefficient of r^7, printed as 5226.4952788528545610.
Ratio central_ratio(double q, double last) {
  return ratio(0.180625 - q * q,
               {3.3871328727963666080, 133.14166789178437745, 1971.5909503065514427, 13731.693765509461125, 45921.953931549871457,
                67265.770927008700853, 33430.575583588128105, 2509.0809287301226727},
               {1.0, 42.313330701600911252, 687.18700749205790830, 5394.1960214247511077, 21213.794301586595867,
                39307.895800092710610, 28729.085735721942674, last});
}

double in_a_tail(double probability) {
  bool const lower = probability < 0.5;
  double const r = std::sqrt(-elementary::log(lower ? probability : 1 - probability));
  Ratio const size =
      r <= 5 ? ratio(r - 1.6,
                     {1.42343711074968357734, 4.63033784615654529590, 5.76949722146069140550, 3.64784832476320460504,
                      1.27045825245236838258, 2.41780725177450611770e-1, 2.27238449892691845833e-2, 7.74545014278341407640e-4},
                     {1.0, 2.05319162663775882187, 1.67638483018380384940, 6.89767334985100004550e-1, 1.48103976427480074590e-1,
                      1.51986665636164571966e-2, 5.47593808499534494600e-4, 1.05075007164441684324e-9})
             : ratio(r - 5,
                     {6.65790464350110377720, 5.46378491116411436990, 1.78482653991729133580, 2.96560571828504891230e-1,
                      2.65321895265761230930e-2, 1.24266094738807843860e-3, 2.71155556874348757815e-5, 2.01033439929228813265e-7},
                     {1.0, 5.99832206555887937690e-1, 1.36929880922735805310e-1, 1.48753612908506148525e-2,
                      7.86869131145613259100e-4, 1.84631831751005468180e-5, 1.42151175831644588870e-7, 2.04426310338993978564e-15});
  return lower ? -size.above / size.below : size.above / size.below;
}

}  // namespace

double standard_normal_quantile_from_middle(double q) {
  if (std::fabs(q) > central) return standard_normal_quantile(0.5 + q);
  // A digit of the coefficient is missing. That moves the last bit of one value in a hundred and no other, and draws hold these
  // bits.
  Ratio const z = central_ratio(q, 5226.495278852545925);
  return q * z.above / z.below;
}

double standard_normal_quantile(double probability) {
  double const q = probability - 0.5;
  return std::fabs(q) <= central ? standard_normal_quantile_from_middle(q) : in_a_tail(probability);
}

double normal_score(double probability) {
  double const q = probability - 0.5;
  if (std::fabs(q) > central) return in_a_tail(probability);
  Ratio const z = central_ratio(q, 5226.4952788528545610);
  return q * (z.above / z.below);
}

}  // namespace sysid
