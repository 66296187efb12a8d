// The SHA-256 digest of a data file: results record from which bytes they were computed.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

/// FIPS 180-4, as 64 hexadecimal digits in lower case. plainly: without the processor's instructions for it, slower.
std::string sha256(std::string_view bytes, bool plainly = false);

}  // namespace sysid
