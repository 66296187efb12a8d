// A fixed parameter of a result. It has a header of its own so that src/typeset includes nothing else of results.
#pragma once
#include <string>

namespace sysid {

/// A parameter that is not estimated, as its file states it.
struct FixedValue {
  std::string name, value, unit;  // "added[bench]", "500", "g"
};

}  // namespace sysid
