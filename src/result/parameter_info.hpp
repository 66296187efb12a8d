// A sampled parameter as results name it.
#pragma once
#include <string>

namespace sysid {

/// A sampled parameter as the user declared it.
struct ParameterInfo {
  std::string name;
  std::string unit;  // as written; may be empty
  double lower,
      upper;  // bounds of the prior's support, declared unit; infinite where there is none or it depends on other parameters
  bool coefficient = false;  // of an unknown function: a search begins with it at zero, whatever the prior draws
};

}  // namespace sysid
