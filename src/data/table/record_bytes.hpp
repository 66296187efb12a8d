// The bytes of a record, read whole.
#pragma once
#include <string>

namespace sysid {

/// IoError where the file cannot be read, or is no regular file; E5003 where it does not fit into memory together with its numbers.
std::string read_record_bytes(std::string const& path);

}  // namespace sysid
