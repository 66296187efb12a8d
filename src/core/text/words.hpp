// Small turns of phrase that messages share.
#pragma once
#include <string>
#include <vector>

namespace sysid {

/// "m", "m and c", "m, c and k".
std::string listed(std::vector<std::string> const& names);

}  // namespace sysid
