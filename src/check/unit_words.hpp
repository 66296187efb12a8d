// Units and kinds of quantities as people call them, for messages: [N], not [kg m/s^2]; "a length".
#pragma once
#include <string>
#include <string_view>

#include "core/unit.hpp"

namespace sysid {

/// The unit as the user wrote it, else in SI with the names that shorten it: "N", "N/m^3", "m/s^2", "rad/s"; "-" for a pure number.
/// newtons: where they are in use, "N s/m" rather than "kg/s".
std::string unit_words(Unit const& unit, bool newtons = false);

/// "a length", "a time", "a stiffness"; "something in [kg/m]" for a dimension without a common name.
std::string kind_words(Dimension const& dimension);
/// Whether that is a plain thing to be asked for: a length, not an energy.
bool is_plain_kind(Dimension const& dimension);

/// 1/dimension.
Dimension inverse(Dimension const& dimension);
/// a/b.
Dimension quotient(Dimension const& a, Dimension const& b);

}  // namespace sysid
