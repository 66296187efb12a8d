// MATLAB files: versions 4 to 7 and 7.3, which is HDF5 within.
#pragma once
#include <string_view>

#include "data/format/variables.hpp"

namespace sysid {

bool is_matlab(std::string_view bytes);
extern VariableFormat const matlab_format;

}  // namespace sysid
