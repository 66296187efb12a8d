// A sampled parameter as results name it.
#pragma once
#include <span>
#include <string>
#include <vector>

namespace sysid {

/// Of an improper prior the coordinate on which the parameter is moved: itself, or a logarithm of the distance from a bound.
enum class Improper { no, line, half_line };

/// A sampled parameter as the user declared it.
struct ParameterInfo {
  std::string name;
  std::string unit;  // as written; may be empty
  double lower,
      upper;  // bounds of the prior's support, declared unit; infinite where there is none or it depends on other parameters
  bool coefficient = false;  // of an unknown function: a search begins with it at zero, whatever the prior draws
  Improper improper = Improper::no;
  bool size_alone = false;  // of a noise, a disturbance or a population: no data are centred on what it changes, and it has no sign
};

/// The coordinates whose prior is improper, ascending.
inline std::vector<int> improper_coordinates(std::span<ParameterInfo const> parameters) {
  std::vector<int> coordinates;
  for (std::size_t p = 0; p < parameters.size(); ++p)
    if (parameters[p].improper != Improper::no) coordinates.push_back(static_cast<int>(p));
  return coordinates;
}

}  // namespace sysid
