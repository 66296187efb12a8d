// What `sysid list` prints, from the tables the language is made of.
#pragma once
#include <string>

namespace sysid {

/// topic: functions, distributions or backends.
std::string list(std::string const& topic);

}  // namespace sysid
