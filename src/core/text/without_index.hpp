// Names of elements and of members of experiments.
#pragma once
#include <string>

namespace sysid {

/// `k` of `k[2]`, `k[bench]` and `k[2,bench]`; a name without an index as it is.
inline std::string without_index(std::string const& name) { return name.substr(0, name.find('[')); }

}  // namespace sysid
