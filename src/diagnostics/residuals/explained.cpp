// The finding and its bounds.
#include "diagnostics/residuals/explained.hpp"

#include <fmt/format.h>

#include <utility>

namespace sysid {

Finding worse_than_the_mean(Severity severity, std::vector<std::string> names, std::string const& channel, double nmse,
                            std::string help) {
  return {FindingCode::worse_than_the_mean, severity, std::move(names),
          fmt::format("{} is predicted worse than by its mean: nmse is {:.3g} %, and 100 % for the mean", channel, nmse),
          std::move(help)};
}

double as_bad_as_the_mean(std::size_t samples) {
  constexpr double excess = 13.8;
  return 100 * (1 + excess / static_cast<double>(samples));
}

}  // namespace sysid
