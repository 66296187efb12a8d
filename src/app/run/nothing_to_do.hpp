// The message for a run of a file that has no task of the requested kind.
#pragma once
#include <string>
#include <vector>

#include "load/load.hpp"

namespace sysid {

/// verbs: those asked for; empty: any. With a task that the file could have.
std::string nothing_to_do(Source const& source, CheckedFile const& file, std::vector<std::string> const& verbs);

}  // namespace sysid
