// A unit in the names that it is written with, with another power of one of them.
#pragma once
#include <string>
#include <string_view>

#include "core/numeric/unit.hpp"

namespace sysid {

/// text times `factor`, in its own names: `N/mm^3` for `N/mm^2` and the factor 1/m. Empty where not exactly one of its names, to a
/// whole power, is the factor.
std::string with_changed_power(std::string_view text, Dimension const& factor);

/// "lbf in" of "lb in": a unit of mass as that of its weight, which engineers mean by it; empty without one. Of kilograms where
/// no mass is counted so: "kg cm", "kg/mm".
std::string with_force_for_mass(std::string_view unit);

}  // namespace sysid
