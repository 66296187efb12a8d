// One row per setting, in the order of `sysid list backends`.
#include "inference/abc/settings.hpp"

#include <limits>

namespace sysid::abc {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity(), least = 1e-300;

constexpr SettingRow rows[] = {
    {"particles", SettingKind::integer, "1000", 10, 1e7, "", "accepted in each population, over all models"},
    {"quantile", SettingKind::real, "0.2", least, 1 - 1e-9, "", "of the last population's distances: the next threshold"},
    {"schedule", SettingKind::numbers, "", least, infinity, "",
     "thresholds of the first populations, falling, in place of quantiles"},
    {"first_threshold", SettingKind::real, "inf", least, infinity, "", "of the population drawn from the priors"},
    {"kernel", SettingKind::word, "gaussian", 0, 0, "gaussian component_gaussian uniform nearest_neighbours",
     "moves particles: by the weighted covariance of their model, its diagonal, a range, the covariance of neighbours"},
    {"neighbours", SettingKind::integer, "50", 2, 1e7, "", "of a particle, for kernel = nearest_neighbours"},
    {"kernel_scale", SettingKind::real, "0", 0, 1e6, "",
     "times the covariance, or width in ranges of the last population for uniform; 0: 2 and 1"},
    {"coordinates", SettingKind::word, "declared", 0, 0, "declared unconstrained", "in which particles are moved"},
    {"model_kernel", SettingKind::word, "prior", 0, 0, "prior previous",
     "draws the model from its prior probability, or moves from that of a particle of the last population"},
    {"stay", SettingKind::real, "0.7", least, 1, "", "probability of staying in the model, for model_kernel = previous"},
    {"threshold_change", SettingKind::real, "0", 0, infinity, "", "stop when the threshold falls by less than this"},
    {"relative_change", SettingKind::real, "0.01", 0, 1, "", "stop when the threshold falls by less than this part of it"},
    {"target", SettingKind::real, "0", 0, infinity, "", "stop at this threshold"},
    {"acceptance", SettingKind::real, "0", 0, 1, "", "stop when a smaller part of the simulations is accepted"},
    {"simulations", SettingKind::real, "1e8", 1, 1e15, "", "stop after so many"},
    {"wall_time", SettingKind::real, "0", 0, 1e9, "", "stop after so many seconds; 0: never"},
    {"populations", SettingKind::integer, "100", 1, 1e6, "", "stop after so many"},
    {"polish", SettingKind::flag, "false", 0, 0, "", "run mh with the likelihood from the particles of each model, and print both"},
    {"cross_check", SettingKind::flag, "true", 0, 0, "", "compare with model probabilities by Laplace's approximation"},
};

}  // namespace

std::span<SettingRow const> settings() { return rows; }

}  // namespace sysid::abc
