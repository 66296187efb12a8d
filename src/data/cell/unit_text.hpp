// Units as programs write them in tables, as units and as the language writes them.
#pragma once
#include <optional>
#include <string>
#include <string_view>

#include "core/numeric/unit.hpp"

namespace sysid {

/// `N`, `[mm]`, `(m/s²)`, `kN.m`, `Deg C`, `Volts`, `µm`, `m s-1`; `text` is what may stand in brackets in a data block. Nothing
/// for what is no unit. A dash or a 1 is the unit of plain numbers.
std::optional<Unit> unit_of_text(std::string_view text);
/// The same where a quantity of the kind of `wanted` is: of an acceleration `g` is no gram but the standard gravity, `g_n` in the
/// language; of a temperature `C` is no coulomb but `degC`.
std::optional<Unit> unit_of_text(std::string_view text, Unit const& wanted);

/// `2.041 N`, `0.57346 mm`: the number and what stands behind it as its unit; nothing for any other text.
struct NumberWithUnit {
  std::string number;
  std::string unit;  // as the language writes it
};
std::optional<NumberWithUnit> split_number(std::string_view cell);

/// `Force (N)`, `Force [N]`, `Force / N`, `Force in N`: the name and what stands there as its unit.
struct NameWithUnit {
  std::string name;
  std::string unit;  // without brackets
};
std::optional<NameWithUnit> split_name(std::string_view text);

}  // namespace sysid
