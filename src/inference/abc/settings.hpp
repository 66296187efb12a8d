// The settings of `abc_smc`.
#pragma once
#include <span>
#include <string>

#include "core/setting/settings.hpp"

namespace sysid::abc {

std::span<SettingRow const> settings();
std::string refuse(Settings const& settings);

}  // namespace sysid::abc
