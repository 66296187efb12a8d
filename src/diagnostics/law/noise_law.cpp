// Growth first: noise of several sizes has heavy tails, too.
#include "diagnostics/law/noise_law.hpp"

#include <fmt/format.h>

#include "diagnostics/law/noise_words.hpp"

namespace sysid {
namespace {

std::string cure_of_growth(LawWords const& words) {
  std::string const relative = free_name(words.names.front() + "_relative", words.taken);
  auto const line = words.proportional(relative);
  std::string const cure = line ? fmt::format("add `parameter {} [-] ~ log_uniform(1e-4, 1)` and write `{}`", relative, *line)
                                : std::string("let the sd of the noise increase with the predicted value");
  return fmt::format(
      "if the noise is in part proportional to the signal, {}; otherwise look for what the model lacks at large "
      "amplitudes",
      cure);
}

}  // namespace

std::optional<Finding> noise_law(ResidualLaw const& law, double limit, LawWords const& words) {
  if (law.grows(limit))
    return Finding{
        FindingCode::noise_law, Severity::warning, words.names,
        fmt::format("the residuals of {} grow with the prediction: where |{}| is in its upper third they are {:.2g} times "
                    "as large as in its lower third",
                    words.channel, words.names.front(), law.growth),
        cure_of_growth(words)};
  if (!law.heavy(limit)) return std::nullopt;
  std::string const check =
      words.largest.empty() ? "check the largest residuals" : fmt::format("check the largest residuals ({})", words.largest);
  return Finding{FindingCode::noise_law, Severity::warning, words.names,
                 fmt::format("the residuals of {} have heavier tails than normal noise (excess kurtosis {:.2g}): a few samples "
                             "have too much influence on the estimates",
                             words.channel, law.excess_kurtosis),
                 words.random_states
                     ? check +
                           ": empty the cells that are not measurements; if all are, the disturbance does not describe "
                           "the motion there"
                     : check + "; if they are measurements, " + use_heavy_tails(words.heavy_tailed())};
}

}  // namespace sysid
