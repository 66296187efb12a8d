// Compressed files as what is in them.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

bool is_gzip(std::string_view bytes);

/// The bytes of all members of a gzip file. UserError (E4023, naming `name`) where they are damaged or end early, E5003 where the
/// content does not fit into memory.
std::string gunzip(std::string const& name, std::string_view bytes);

}  // namespace sysid
