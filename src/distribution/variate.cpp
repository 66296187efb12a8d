// Variates that several distributions share, from core/numeric/elementary alone: the same bits on every processor.
#include <cmath>

#include "core/numeric/elementary.hpp"
#include "distribution/rows.hpp"

namespace sysid {

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
