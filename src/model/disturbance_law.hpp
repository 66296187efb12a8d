// The laws of disturbances in continuous time, one row each. In discrete time a disturbance is drawn from a normal distribution.
#pragma once
#include <span>
#include <string_view>

namespace sysid {

/// Its unit is that of the disturbance to a power, times seconds to another.
struct DisturbanceArgumentRow {
  std::string_view name;
  int unit_power = 0;
  int second_power = 0;
};

struct DisturbanceLawRow {
  std::string_view name;
  std::string_view usage;    // "white(intensity = q)"
  std::string_view summary;  // one line of help
  std::span<DisturbanceArgumentRow const> arguments;
  bool has_memory = false;  // a state besides
};

std::span<DisturbanceLawRow const> disturbance_laws();
/// Null for any other name.
DisturbanceLawRow const* find_disturbance_law(std::string_view name);

}  // namespace sysid
