// Hampel's identifier, against the stated size of the noise as well.
#include "diagnostics/residuals/outliers.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/statistics.hpp"

namespace sysid {

std::vector<std::size_t> outliers(std::span<double const> residuals) {
  constexpr std::size_t least = 20;
  std::vector<double> sizes;
  for (double const residual : residuals)
    if (!std::isnan(residual)) sizes.push_back(std::fabs(residual));
  if (sizes.size() < least) return {};
  double const limit = far_off_sds * std::max(1.0, sd_of_mad * upper_median(sizes));
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < residuals.size(); ++i)
    if (std::fabs(residuals[i]) > limit) places.push_back(i);
  if (places.size() > std::max<std::size_t>(1, sizes.size() / 100)) places.clear();
  return places;
}

}  // namespace sysid
