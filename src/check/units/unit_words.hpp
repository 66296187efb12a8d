// Names of units and of kinds of quantities for messages: [N], not [kg m/s^2]; "a length".
#pragma once
#include <functional>
#include <set>
#include <string>
#include <string_view>

#include "core/numeric/unit.hpp"

namespace sysid {

/// Names of derived units that a text writes, without prefixes: "N" of kN/mm.
using UnitNames = std::set<std::string, std::less<>>;
/// Adds the names in a unit as it is written.
void add_unit_names(std::string_view text, UnitNames& names);

/// The unit as the user wrote it, else in kg, m, s and the other base units, shortened by the names that are in use: "N/m^3" of a
/// text with newtons, "kg/(m^2 s^2)" without; "rad/s"; "-" for a pure number.
std::string unit_words(Unit const& unit, UnitNames const& in_use);

/// "a length", "a time", "a stiffness"; "something in [kg/m]" for a dimension without a common name.
std::string kind_words(Dimension const& dimension, UnitNames const& in_use);
/// Whether that is a plain thing to be asked for: a length, not an energy.
bool is_plain_kind(Dimension const& dimension);

/// 1/dimension.
Dimension inverse(Dimension const& dimension);
/// a/b.
Dimension quotient(Dimension const& a, Dimension const& b);

}  // namespace sysid
