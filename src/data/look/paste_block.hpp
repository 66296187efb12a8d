// The data block of a record that was looked at: every column of numbers as a measured channel, for the user to make inputs of
// some.
#pragma once
#include <string>

#include "data/look/record_look.hpp"

namespace sysid {

std::string paste_block(RecordLook const& look);

}  // namespace sysid
