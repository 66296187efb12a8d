// The table of settings, and values that do not go together.
#include "inference/abc/settings.hpp"

#include "core/numeric/not_finite.hpp"

#include <fmt/format.h>

namespace sysid::abc {
namespace {

constexpr SettingRow rows[] = {
    {"particles", SettingKind::integer, "1000", 10, 1e7, "", "of each population, over all models"},
    {"quantile", SettingKind::real, "0.2", 1e-6, 0.999999, "",
     "the next threshold is this quantile of the distances of all particles, unweighted"},
    {"schedule", SettingKind::numbers, "", 0, infinity, "", "thresholds one after another instead, falling: `(100, 10, 1)`"},
    {"first_threshold", SettingKind::real, "0", 0, infinity, "",
     "of population 1; 0: every draw of the prior that can be simulated"},
    {"kernel", SettingKind::word, "gaussian", 0, 0, "gaussian component_gaussian uniform nearest_neighbours",
     "how a particle moves: normal with the population's covariance, its diagonal, a box of its range, or normal with the "
     "covariance of the nearest neighbours"},
    {"kernel_scale", SettingKind::real, "0", 0, 1e12, "",
     "factor on that covariance, or on the range; 0: 2 for the population's covariance, else 1", 1e-6},
    {"neighbours", SettingKind::integer, "50", 2, 1e7, "", "that shape the kernel `nearest_neighbours`"},
    {"coordinates", SettingKind::word, "natural", 0, 0, "natural declared unconstrained",
     "the kernel moves logarithms of parameters whose prior spans decades and declared values of the others, declared values, or "
     "the sampler's coordinates, which never leave the prior's support"},
    {"model_kernel", SettingKind::word, "prior", 0, 0, "prior previous",
     "models are drawn from their prior, or from the last population and moved"},
    {"stay", SettingKind::real, "0.7", 0, 1, "", "probability that such a move stays with the model"},
    {"threshold_change", SettingKind::real, "0", 0, infinity, "", "stop when the threshold falls by no more than this"},
    {"relative_change", SettingKind::real, "0.01", 0, 1, "", "stop when it falls by no more than this part of itself"},
    {"target", SettingKind::real, "0", 0, infinity, "", "stop at this threshold"},
    {"acceptance", SettingKind::real, "0", 0, 1, "", "stop when a smaller part of the proposals is accepted"},
    {"simulations", SettingKind::real, "1e8", 1, 1e18, "", "stop after so many in all"},
    {"wall_time", SettingKind::real, "0", 0, infinity, "", "stop after so many seconds, which no seed repeats; 0: no limit"},
    {"populations", SettingKind::integer, "100", 1, 1e6, "", "stop after so many"},
    {"cross_check", SettingKind::flag, "true", 0, 0, "",
     "set Laplace's model probabilities beside these, and test what the best model leaves"},
    {"polish", SettingKind::flag, "false", 0, 0, "", "go on from the particles with Metropolis-Hastings on the likelihood"},
    {"polish_samples", SettingKind::integer, "25000", 100, 1e8, "",
     "iterations of each of its four chains, a fifth of them burn-in"},
};

}  // namespace

std::span<SettingRow const> settings() { return rows; }

std::string refuse(Settings const& settings) {
  std::vector<double> const& schedule = settings.numbers("schedule");
  for (std::size_t t = 1; t < schedule.size(); ++t)
    if (!(schedule[t] < schedule[t - 1]))
      return fmt::format("the schedule must fall, but {} follows {}", schedule[t], schedule[t - 1]);
  if (!schedule.empty() && settings.real("first_threshold") > 0)
    return "the schedule holds the first threshold: leave `first_threshold` out";
  // Each of these would be read by nobody.
  auto const given = [&](char const* name) { return settings.all().at(name) != Settings(rows).all().at(name); };
  auto const idle = [&](bool used, std::initializer_list<char const*> names, char const* why) -> std::string {
    for (char const* name : names)
      if (!used && given(name)) return fmt::format("`{}` has no say {}", name, why);
    return {};
  };
  for (std::string const& why :
       {idle(schedule.empty(), {"quantile", "target", "threshold_change", "relative_change"},
             "where a `schedule` gives the thresholds"),
        idle(settings.word("kernel") == "nearest_neighbours", {"neighbours"}, "but with `kernel = nearest_neighbours`"),
        idle(settings.word("model_kernel") == "previous", {"stay"}, "but with `model_kernel = previous`"),
        idle(settings.flag("polish"), {"polish_samples"}, "without `polish = yes`")})
    if (!why.empty()) return why;
  return {};
}

}  // namespace sysid::abc
