// The table of settings, and values that do not go together.
#include "inference/abc/settings.hpp"

#include "core/numeric/not_finite.hpp"

#include <fmt/format.h>

namespace sysid::abc {
namespace {

constexpr SettingRow rows[] = {
    {"particles", SettingKind::integer, "1000", 10, 1e7, "", "particles in each population, of all models together"},
    {"quantile", SettingKind::real, "0.2", 1e-6, 0.999999, "",
     "the next threshold is this unweighted quantile of the distances of all particles"},
    {"schedule", SettingKind::numbers, "", 0, infinity, "", "decreasing thresholds, used in place of the quantile: `(100, 10, 1)`"},
    {"first_threshold", SettingKind::real, "0", 0, infinity, "",
     "threshold of population 1; 0: every prior draw that can be simulated is accepted"},
    {"kernel", SettingKind::word, "gaussian", 0, 0, "gaussian component_gaussian uniform nearest_neighbours",
     "how a particle moves; gaussian: normal with the population's covariance; component_gaussian: normal with the "
     "diagonal of this covariance; uniform: uniform in a box around the particle, as wide as the population's range; "
     "nearest_neighbours: normal with the covariance of the nearest neighbours"},
    {"kernel_scale", SettingKind::real, "0", 0, 1e12, "",
     "factor on the covariance or range of the kernel; 0 stands for 2 with gaussian and component_gaussian, and for 1 with the "
     "others",
     1e-6},
    {"neighbours", SettingKind::integer, "50", 2, 1e7, "", "number of neighbours in the kernel `nearest_neighbours`"},
    {"coordinates", SettingKind::word, "natural", 0, 0, "natural declared unconstrained",
     "what the kernel moves; natural: logarithms where the prior spans decades, declared values elsewhere; declared: declared "
     "values; unconstrained: coordinates that stay in the prior's support"},
    {"model_kernel", SettingKind::word, "prior", 0, 0, "prior previous",
     "prior: models are drawn from their prior; previous: from the last population, then changed at random"},
    {"stay", SettingKind::real, "0.7", 0, 1, "", "probability that `model_kernel = previous` keeps the model"},
    {"threshold_change", SettingKind::real, "0", 0, infinity, "", "stop when the threshold decreases by no more than this"},
    {"relative_change", SettingKind::real, "0.01", 0, 1, "",
     "stop when the threshold decreases by no more than this fraction of its value"},
    {"target", SettingKind::real, "0", 0, infinity, "", "stop at this threshold"},
    {"acceptance", SettingKind::real, "0", 0, 1, "", "stop when the acceptance rate of the proposals is below this"},
    {"simulations", SettingKind::real, "1e8", 1, 1e18, "", "stop after this many simulations"},
    {"wall_time", SettingKind::real, "0", 0, infinity, "", "stop after this many seconds, which is not reproducible; 0: no limit",
     0, "s"},
    {"populations", SettingKind::integer, "100", 1, 1e6, "", "stop after this many populations"},
    {"cross_check", SettingKind::flag, "yes", 0, 0, "",
     "compare with Laplace's model probabilities, and test the residuals of the best model"},
    {"polish", SettingKind::flag, "no", 0, 0, "",
     "sample the posterior of each model of probability 0.01 or more by Metropolis-Hastings on the likelihood, from its modes"},
    {"polish_samples", SettingKind::integer, "25000", 100, 1e8, "",
     "iterations, a fifth of them burn-in, of each of the four chains of `polish`"},
};

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings) {
  std::vector<double> const& schedule = settings.numbers("schedule");
  for (std::size_t t = 1; t < schedule.size(); ++t)
    if (!(schedule[t] < schedule[t - 1]))
      return fmt::format("the schedule must decrease, but {} follows {}", schedule[t], schedule[t - 1]);
  if (!schedule.empty() && settings.real("first_threshold") > 0)
    return "the schedule contains the first threshold: remove `first_threshold`";
  // Each of these would be read by nobody.
  auto const given = [&](char const* name) { return settings.all().at(name) != Settings(rows).all().at(name); };
  auto const idle = [&](bool used, std::initializer_list<char const*> names, char const* why) -> std::string {
    for (char const* name : names)
      if (!used && given(name)) return fmt::format("`{}` has no effect {}", name, why);
    return {};
  };
  for (std::string const& why :
       {idle(schedule.empty(), {"quantile", "target", "threshold_change", "relative_change"}, "with a `schedule` of thresholds"),
        idle(settings.word("kernel") == "nearest_neighbours", {"neighbours"}, "without `kernel = nearest_neighbours`"),
        idle(settings.word("model_kernel") == "previous", {"stay"}, "without `model_kernel = previous`"),
        idle(settings.flag("polish"), {"polish_samples"}, "without `polish = yes`")})
    if (!why.empty()) return why;
  return {};
}

}  // namespace sysid::abc
