// The normal's quantiles.
#include "result/function.hpp"

#include "core/numeric/statistics.hpp"

namespace sysid {

void FunctionPoint::set_normal(double normal_mean, double normal_sd) {
  mean = normal_mean;
  sd = normal_sd;
  q5 = mean - normal_quantile_95 * sd;
  q95 = mean + normal_quantile_95 * sd;
}

}  // namespace sysid
