// The table.
#include "model/disturbance_law.hpp"

namespace sysid {
namespace {

constexpr DisturbanceArgumentRow white_arguments[] = {{"intensity", 2, 1}};
constexpr DisturbanceArgumentRow ornstein_uhlenbeck_arguments[] = {{"sd", 1, 0}, {"time", 0, 1}};

/// white: E[w(t) w(s)] = q delta(t - s). ornstein_uhlenbeck: stationary, E[w(t) w(s)] = sd^2 exp(-|t - s|/time), so that
/// w' = -w/time + v with white v of intensity 2 sd^2/time (Gardiner 2009, section 4.4.4).
constexpr DisturbanceLawRow rows[] = {
    {"white", "white(intensity = q)", "white noise; the unit of its intensity: the square of the disturbance's unit, times seconds",
     white_arguments, false},
    {"ornstein_uhlenbeck", "ornstein_uhlenbeck(sd = s, time = T)",
     "correlated noise of standard deviation s, correlation exp(-t/T)", ornstein_uhlenbeck_arguments, true},
};

}  // namespace

std::span<DisturbanceLawRow const> disturbance_laws() { return rows; }

DisturbanceLawRow const* find_disturbance_law(std::string_view name) {
  for (DisturbanceLawRow const& row : rows)
    if (row.name == name) return &row;
  return nullptr;
}

}  // namespace sysid
