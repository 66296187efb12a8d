// Errors of the units of columns (E40). One named constructor per mistake.
#pragma once
#include <string>

#include "data/table/error_parts.hpp"

namespace sysid::data_errors {

/// E4026. stated: in the data block; found: in the file.
Diagnostic unit_differs(std::string const& file, std::string const& column, std::string const& stated, std::string const& found,
                        Mention mention);
/// Such as `F [kN]`, a name with its unit.
struct NamedUnit {
  std::string column, bare;
};
struct TwoUnits {
  std::string stated, found;  // in the data block, in the file
  std::string to_write{};     // what the data block should have for `found`; empty: the same
};
/// E4026. is_text: `read` can be said of the file.
Diagnostic unit_differs_from_name(std::string const& file, NamedUnit const& name, TwoUnits const& units, bool is_text,
                                  Mention mention);
Diagnostic unit_unknown(std::string const& file, std::string const& column, std::string const& found, Mention mention);
Diagnostic unit_of_another_kind(std::string const& file, std::string const& column, std::string const& found,
                                std::string const& wanted, Mention mention);
Diagnostic cycles_against_radians(std::string const& column, std::string const& column_unit, std::string const& declared_unit,
                                  Mention mention);

}  // namespace sysid::data_errors
