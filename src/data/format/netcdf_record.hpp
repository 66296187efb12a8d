// NetCDF files of all versions, and HDF5 files that others wrote.
#pragma once
#include <string_view>

#include "data/format/variables.hpp"

namespace sysid {

bool is_netcdf(std::string_view bytes);
extern VariableFormat const netcdf_format;

}  // namespace sysid
