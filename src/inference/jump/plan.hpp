// The settings of `reversible_jump`, and its plan: they are read once.
#pragma once
#include <cstdint>
#include <span>
#include <string>

#include "core/setting/settings.hpp"

namespace sysid::jump {

std::span<SettingRow const> settings();
std::string refuse(Settings const& settings);

struct Plan {
  std::uint64_t samples = 0, burn_in = 0, thin = 1;
  int chains = 1;
  std::int64_t pilot = 0;  // iterations of each chain of a pilot

  /// Moves of a cycle: jumps, whose proposals do not depend on where a chain is and are simulated together, then walks.
  static constexpr std::uint64_t cycle = 8, walks = 2;
  static bool is_walk(std::uint64_t iteration) { return iteration % cycle >= cycle - walks; }

  /// Parts of a chain after burn-in whose scatter gives the errors.
  std::uint64_t parts() const;
  std::uint64_t part_of(std::uint64_t iteration) const;
};

Plan plan_of(Settings const& settings);

}  // namespace sysid::jump
