// What findings on residuals share, within this folder and outside.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "diagnostics/prior_checks.hpp"
#include "diagnostics/residual_checks.hpp"

namespace sysid {

void name_held(Report const& report, Findings& findings) {
  std::vector<std::string> held;
  for (PriorInfo const& prior : report.priors)
    for (Summary const& summary : report.summary)
      if (summary.name == prior.name && !summary.coefficient)
        if (auto const ratio = contraction(prior, summary); ratio && *ratio < hardly_narrower) held.push_back(summary.name);
  constexpr std::size_t most_named = 6;
  if (held.empty() || held.size() > most_named) return;
  for (Finding& each : findings)
    if (each.code == FindingCode::explains_little || each.code == FindingCode::worse_than_the_mean)
      each.help +=
          held.size() == 1
              ? fmt::format("; the posterior of {} is nearly as wide as its prior: check this prior", held.front())
              : fmt::format("; the posteriors of {} are nearly as wide as their priors: check these priors", fmt::join(held, ", "));
}

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
