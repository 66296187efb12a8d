// The data elements of a MATLAB file of versions 5 to 7, by their lengths.
#pragma once
#include <string_view>

namespace sysid {

/// Whether all elements are there to their last byte, and arrays of numbers have as many as their sizes say. libmatio leaves the
/// numbers that a cut file lacks as they were in memory, and says nothing.
bool matlab_elements_are_whole(std::string_view bytes);

}  // namespace sysid
