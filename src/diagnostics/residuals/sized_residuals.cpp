// Sizes by variances of counts and by moments of deviances.
#include "diagnostics/residuals/sized_residuals.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "distribution/deviance.hpp"

namespace sysid {

SizedResiduals pearson_residuals(DistributionRow const& noise, std::vector<double> const& measured,
                                 std::vector<std::vector<double>> const& arguments, std::vector<double> const& deviance) {
  SizedResiduals result{std::vector<double>(deviance.size(), std::nan("")), 0, std::vector<double>(deviance.size(), 0.0)};
  for (std::size_t i = 0; i < deviance.size(); ++i) {
    if (std::isnan(deviance[i])) continue;
    double const variance = noise.variance(arguments[i]);
    if (!(variance >= std::numeric_limits<double>::min())) continue;  // its inverse is no number
    result.values[i] = (measured[i] - arguments[i][0]) / std::sqrt(variance);
    result.degrees[i] = 2 / (2 + noise.excess_kurtosis(arguments[i]));
  }
  return result;
}

SizedResiduals scaled_residuals(DistributionRow const& noise, std::vector<std::vector<double>> const& arguments,
                                std::vector<double> deviance) {
  constexpr std::size_t examined = 4;
  DevianceMoments moments{0, 0};
  double count = 0;
  std::size_t const step = std::max<std::size_t>(1, deviance.size() / examined);
  for (std::size_t i = 0; i < deviance.size(); ++i) {
    if (std::isnan(deviance[i]) || (count > 0 && i % step != 0) || !noise.refuse(arguments[i]).empty()) continue;
    DevianceMoments const here = deviance_moments(noise, arguments[i]);
    moments.mean += here.mean;
    moments.variance += here.variance;
    count += 1;
  }
  if (count == 0) return {std::move(deviance), 0, {}};
  moments = {moments.mean / count, moments.variance / count};
  constexpr double as_normal = 1e-4;
  if (std::fabs(moments.mean - 1) < as_normal) return {std::move(deviance), 0, {}};
  for (double& residual : deviance) residual /= std::sqrt(moments.mean);
  return {std::move(deviance), moments.excess_kurtosis(), {}};
}

}  // namespace sysid
