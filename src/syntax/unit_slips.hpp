// Common mistakes in units: [N/m3], [Kg], [Nm], [kmh].
#pragma once
#include <optional>
#include <string>
#include <string_view>

namespace sysid {

/// A word that is no unit, and what its letters say that it was meant as.
struct UnitSlip {
  enum class Kind { power, product, capitals, key, quotient, molar };
  Kind kind;
  std::string meant;  // "m^3", "N m", "kg", "km/h", "mmol/l"
};

/// Nothing where the letters do not tell.
std::optional<UnitSlip> unit_slip(std::string_view word);

}  // namespace sysid
