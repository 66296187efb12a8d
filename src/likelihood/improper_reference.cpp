// Draws and densities of what stands in for an improper prior.
#include "likelihood/improper_reference.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/numeric/elementary.hpp"

namespace sysid {

double ImproperReference::draw(double lower, double upper, double unit, Stream& stream) const {
  bool const above = std::isfinite(lower), below = std::isfinite(upper);
  auto const from_bound = [&](double distance) {
    return above ? lower + std::max(distance, least_distance * std::fabs(lower))
                 : upper - std::max(distance, least_distance * std::fabs(upper));
  };
  if (kind == Kind::normal) {
    double const u = centre + width * stream.normal();
    if (above && below) return lower + (upper - lower) / (1 + elementary::exp(-u));
    return above || below ? from_bound(elementary::exp(u)) : u;
  }
  if (above && below) return lower + (upper - lower) * stream.uniform();
  double const exponent = centre + width * (2 * stream.uniform() - 1);
  double const distance = elementary::exp(std::numbers::ln10 * exponent) * unit;
  if (above || below) return from_bound(distance);
  return stream.uniform() < 0.5 ? distance : -distance;
}

double ImproperReference::log_density(double theta) const {
  double const z = (theta - centre) / width;
  return -0.5 * z * z - elementary::log(width) - 0.5 * elementary::log(2 * std::numbers::pi);
}

}  // namespace sysid
