// The finding and its bounds.
#include "diagnostics/residuals/explained.hpp"

#include <fmt/format.h>

#include <array>
#include <utility>

#include "core/numeric/not_finite.hpp"
#include "distribution/distribution.hpp"

namespace sysid {

Finding worse_than_the_mean(Severity severity, std::vector<std::string> names, std::string const& channel, double nmse,
                            std::string help) {
  return {FindingCode::worse_than_the_mean, severity, std::move(names),
          fmt::format("{} is predicted worse than by its mean: nmse is {:.3g} %, and 100 % for the mean", channel, nmse),
          std::move(help)};
}

double as_bad_as_the_mean(std::size_t samples) {
  constexpr double by_chance = 1e-3;
  if (samples < 2) return infinity;
  double const freedom = static_cast<double>(samples - 1);
  std::array<double, 3> const standard = {0, freedom, 1};
  double const t = find_distribution("student_t")->quantile(by_chance / 2, Tail::upper, standard);
  return 100 * (1 + t * t / freedom);
}

}  // namespace sysid
