#include "data/table/column_unit_errors.hpp"

#include <fmt/format.h>

namespace sysid::data_errors {

Diagnostic unit_differs(std::string const& file, std::string const& column, std::string const& stated, std::string const& found,
                        Mention mention) {
  return error("E4026", mention,
               fmt::format("column `{}` is in [{}] here, but `{}` states its unit as {}", shown(column), stated, file, found),
               "one of the two is wrong: write the unit that the numbers have, or no unit to use the one in the file");
}

Diagnostic unit_differs_from_name(std::string const& file, NamedUnit const& name, TwoUnits const& units, bool is_text,
                                  Mention mention) {
  std::string help = fmt::format("one of the two is wrong: write the unit that its numbers have, `[{}]`",
                                 units.to_write.empty() ? as_unit(units.found) : units.to_write);
  if (is_text)
    help += fmt::format(
        ", or add `read units = names` and write `{}` without a unit; where the name is wrong, name the columns with `read "
        "columns`",
        shown(name.bare));
  return error("E4026", mention,
               fmt::format("column `{}` is in [{}] here, but in `{}` its name has the unit {}", shown(name.column), units.stated,
                           file, shown(units.found)),
               std::move(help));
}

Diagnostic unit_unknown(std::string const& file, std::string const& column, std::string const& found, Mention mention) {
  return error("E4026", mention,
               fmt::format("the unit of column `{}` in `{}`{} is not known", shown(column), file,
                           found.empty() ? "" : fmt::format(", `{}`,", found)),
               fmt::format("write it in the data block, in brackets after the column: `{} [N]`", shown(column)));
}

Diagnostic unit_of_another_kind(std::string const& file, std::string const& column, std::string const& found,
                                std::string const& wanted, Mention mention) {
  return error("E4026", mention,
               fmt::format("column `{}` is in [{}] in `{}`, but [{}] is needed", shown(column), found, file, wanted),
               "use the column of the right quantity; units of one kind are converted");
}

Diagnostic cycles_against_radians(std::string const& column, std::string const& column_unit, std::string const& declared_unit,
                                  Mention mention) {
  Diagnostic result =
      error("E4017", mention,
            fmt::format("column `{}` is in [{}], but [{}] is needed: one counts cycles, the other radians, so they "
                        "differ by a factor of 2 pi",
                        column, column_unit, declared_unit),
            fmt::format("declare it in the model in [{}], as its numbers are, and write the factor 2*pi there where "
                        "one is needed",
                        column_unit));
  result.names = {column};
  return result;
}

}  // namespace sysid::data_errors
