// Variates and quantiles that several distributions share, from core/elementary alone: the same bits on every processor.
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"

namespace sysid {

/// Algorithm AS 241, PPND16: rational approximations, relative error about 1e-16.         Wichura 1988, Applied Statistics 37, 477
double standard_normal_quantile_from_middle(double q) {
  if (std::fabs(q) > 0.425) return standard_normal_quantile(0.5 + q);
  double const r = 0.180625 - q * q;
  double const above =
      ((((((2509.0809287301226727 * r + 33430.575583588128105) * r + 67265.770927008700853) * r + 45921.953931549871457) * r +
         13731.693765509461125) *
            r +
        1971.5909503065514427) *
           r +
       133.14166789178437745) *
          r +
      3.387132872796366608;
  double const below =
      ((((((5226.495278852545925 * r + 28729.085735721942674) * r + 39307.89580009271061) * r + 21213.794301586595867) * r +
         5394.1960214247511077) *
            r +
        687.1870074920579083) *
           r +
       42.313330701600911252) *
          r +
      1;
  return q * above / below;
}

double standard_normal_quantile(double probability) {
  double const q = probability - 0.5;
  if (std::fabs(q) <= 0.425) return standard_normal_quantile_from_middle(q);
  double r = std::sqrt(-elementary::log(q < 0 ? probability : 1 - probability));
  double above, below;
  if (r <= 5) {
    r -= 1.6;
    above =
        ((((((7.7454501427834140764e-4 * r + 0.0227238449892691845833) * r + 0.24178072517745061177) * r + 1.27045825245236838258) *
               r +
           3.64784832476320460504) *
              r +
          5.7694972214606914055) *
             r +
         4.6303378461565452959) *
            r +
        1.42343711074968357734;
    below = ((((((1.05075007164441684324e-9 * r + 5.475938084995344946e-4) * r + 0.0151986665636164571966) * r +
                0.14810397642748007459) *
                   r +
               0.68976733498510000455) *
                  r +
              1.6763848301838038494) *
                 r +
             2.05319162663775882187) *
                r +
            1;
  } else {
    r -= 5;
    above = ((((((2.01033439929228813265e-7 * r + 2.71155556874348757815e-5) * r + 0.0012426609473880784386) * r +
                0.026532189526576123093) *
                   r +
               0.29656057182850489123) *
                  r +
              1.7848265399172913358) *
                 r +
             5.4637849111641143699) *
                r +
            6.6579046435011037772;
    below = ((((((2.04426310338993978564e-15 * r + 1.4215117583164458887e-7) * r + 1.8463183175100546818e-5) * r +
                7.868691311456132591e-4) *
                   r +
               0.0148753612908506148525) *
                  r +
              0.13692988092273580531) *
                 r +
             0.59983220655588793769) *
                r +
            1;
  }
  return q < 0 ? -above / below : above / below;
}

/// Marsaglia and Tsang 2000, "A simple method for generating gamma variables": d V with V = (1 + Z/sqrt(9 d))^3, d = shape - 1/3,
/// accepted with the density's ratio; below shape 1, a variate of shape + 1 times U^(1/shape).
double log_standard_gamma(double shape, Stream& stream) {
  if (shape < 1) {
    double const boost = elementary::log(stream.uniform()) / shape;
    return log_standard_gamma(shape + 1, stream) + boost;
  }
  double const d = shape - 1. / 3;
  double const c = 1 / std::sqrt(9 * d);
  for (;;) {
    double const z = stream.normal();
    double const root = 1 + c * z;
    if (root <= 0) continue;
    double const v = root * root * root;
    double const log_v = elementary::log(v);
    if (elementary::log(stream.uniform()) < 0.5 * z * z + d * (1 - v + log_v)) return elementary::log(d) + log_v;
  }
}

}  // namespace sysid
