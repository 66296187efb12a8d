// Named values.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "core/setting/settings.hpp"

namespace sysid {

/// In the order in which they are shown.
using Facts = std::vector<std::pair<std::string, SettingValue>>;

}  // namespace sysid
