// Experiments in messages.
#pragma once
#include <string>

namespace sysid {

/// " on bench.train", where there are several to tell apart.
inline std::string on_experiment(std::string const& name, bool several) { return several ? " on " + name : std::string(); }

}  // namespace sysid
