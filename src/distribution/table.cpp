// All distributions of the language, in the order `sysid list distributions` prints. A new one is a file and a line here.
#include "distribution/rows.hpp"

#include "core/setting/table.hpp"

namespace sysid {

std::span<DistributionRow const> distributions() {
  static DistributionRow const rows[] = {
      uniform_distribution(),     log_uniform_distribution(),       normal_distribution(),      log_normal_distribution(),
      half_normal_distribution(), student_t_distribution(),         half_cauchy_distribution(), exponential_distribution(),
      gamma_distribution(),       inverse_gamma_distribution(),     beta_distribution(),        flat_distribution(),
      poisson_distribution(),     negative_binomial_distribution(),
  };
  return rows;
}

DistributionRow const* find_distribution(std::string_view name) { return row_named(distributions(), name); }

}  // namespace sysid
