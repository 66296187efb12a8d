// Terms that a dictionary could contain and does not, in words: for `check` and for the report of a discovery.
#pragma once
#include <string>
#include <vector>

#include "check/checked/checked.hpp"

namespace sysid {

struct ExcludedText {
  std::string term;    // "y*y'"; where it is left out of one equation of several, "y*y' for x'"
  std::string reason;  // "excluded", "the same as y'*y", "its coefficient would be in [N/m^2]"
};

/// In the order in which they were left out.
std::vector<ExcludedText> excluded_texts(CheckedDictionary const& dictionary);

}  // namespace sysid
