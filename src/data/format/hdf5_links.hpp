// Links of HDF5 files to datasets of other files, as bytes: the netCDF library opens no file that has one whose target is not
// there.
#pragma once
#include <string>
#include <string_view>

namespace sysid {

/// The name of the other file in the first such link; empty where there is none.
std::string external_link_in(std::string_view bytes);

}  // namespace sysid
