// MATLAB files of version 4, which have no head: matrices, each with a header of five numbers, one after the other.
#pragma once
#include <string_view>

namespace sysid {

/// Whether a matrix of version 4 begins here; it need not be whole.
bool is_matlab4(std::string_view bytes);
/// Whether all matrices are there to their last byte.
bool matlab4_is_whole(std::string_view bytes);

}  // namespace sysid
