// The settings of `abc_smc`.
#pragma once
#include <span>

#include "core/settings.hpp"

namespace sysid::abc {

std::span<SettingRow const> settings();

}  // namespace sysid::abc
