// Units of columns: in the data block, stated by the file, in names of columns.
#include "data/column_units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/text/words.hpp"
#include "data/cell/column_name.hpp"
#include "data/cell/unit_text.hpp"
#include "data/table/column_unit_errors.hpp"

namespace sysid {

void to_si(std::vector<double>& values, ColumnRequest const& request) {
  std::optional<Unit> const& declared = request.declared ? request.declared : request.unit;
  if (!declared) return;
  Unit const& unit = request.unit ? *request.unit : *declared;
  if (unit.dimension != declared->dimension)
    throw InternalError(
        fmt::format("column `{}` in [{}] was let through for a quantity in [{}]", request.column, unit.text, declared->text));
  if (cycles_against_radians(unit, *declared))
    throw UserError(data_errors::cycles_against_radians(request.column, unit.text, declared->text, request.mention));
  // convert applies the offset; a declared degC stays degrees above 0 degC in the equations.
  for (double& value : values) value = convert(value, unit, *declared) * declared->scale;
}

bool same_unit(Unit const& a, Unit const& b) {
  bool const turns = cycles_against_radians(a, b);
  if (turns && a.hertz == b.hertz) return true;
  auto const same = [](double x, double y) { return std::fabs(x - y) <= 1e-9 * std::max(std::fabs(x), std::fabs(y)); };
  return a.dimension == b.dimension && same(a.scale, b.scale) && !turns &&
         (same(a.offset, b.offset) || is_named_difference(a) || is_named_difference(b));
}

namespace {

/// `F [kN]` that the data block has in N. What is no unit of the kind that is wanted may be no unit at all, as in `sensor (A)`; two
/// letters in square brackets are one.
void refuse_other_unit_in_name(RecordFile const& file, std::string const& column, Unit const& stated, std::optional<Span> mention) {
  auto const split = split_name(column);
  std::optional<Unit> const unit = split ? unit_of_text(split->unit, stated) : std::nullopt;
  if (!unit) return;
  bool const surely = trimmed(column).ends_with(']') && split->unit.size() > 1;
  if (same_unit(*unit, stated) || (unit->dimension != stated.dimension && !surely)) return;
  throw UserError(data_errors::unit_differs_from_name(
      file.name(), {column, split->name}, {stated.text, split->unit, unit->dimension == stated.dimension ? unit->text : ""},
      file.row_count().has_value(), mention));
}

/// Of another kind of quantity than the data block has. A text table need not be read with its units; other files have no way out.
bool wrong_unit_of_file(RecordFile const& file, Unit const& in_file, Unit const& stated) {
  return !file.row_count() && in_file.dimension != stated.dimension;
}

}  // namespace

void refuse_unit_left_out(RecordFile const& file, std::string const& column, Unit const& read_in, std::optional<Span> mention) {
  auto const split = split_name(column);
  std::optional<Unit> const unit = split ? unit_of_text(split->unit, read_in) : std::nullopt;
  if (!unit || unit->dimension != read_in.dimension || same_unit(*unit, read_in)) return;
  throw UserError(data_errors::unit_differs_from_name(file.name(), {column, split->name},
                                                      {read_in.text_or_dimension(), split->unit, unit->text},
                                                      file.row_count().has_value(), mention));
}

void take_unit_of_file(RecordFile const& file, ColumnRequest& request) {
  std::optional<std::string> const text = file.unit(request.column);
  if (!text && request.unit) refuse_other_unit_in_name(file, request.column, *request.unit, request.mention);
  if (!text && !request.unit && request.declared) refuse_unit_left_out(file, request.column, *request.declared, request.mention);
  if (!text) return;
  std::optional<Unit> const& wanted = request.unit ? request.unit : request.declared;
  std::optional<Unit> const unit = wanted ? unit_of_text(*text, *wanted) : unit_of_text(*text);
  if (request.unit) {
    if (unit && !same_unit(*unit, *request.unit) && !wrong_unit_of_file(file, *unit, *request.unit))
      throw UserError(data_errors::unit_differs(file.name(), request.column, request.unit->text, unit->text, request.mention));
    return;
  }
  if (!unit && !text->empty()) throw UserError(data_errors::unit_unknown(file.name(), request.column, {}, request.mention));
  if (!unit) return;
  if (request.declared && unit->dimension != request.declared->dimension)
    throw UserError(data_errors::unit_of_another_kind(file.name(), request.column, unit->text,
                                                      request.declared->text_or_dimension(), request.mention));
  request.unit = unit;
  // A file that calls differences of temperatures degC does not mean that they begin at 273.15 K.
  if (request.declared && is_named_difference(*request.declared)) request.unit->offset = 0;
}

std::optional<UnitInName> wrong_unit_in_file(RecordFile const& file, ColumnRequest const& request) {
  auto const text = file.unit(request.column);
  std::optional<Unit> const unit = text && request.unit ? unit_of_text(*text, *request.unit) : std::nullopt;
  if (!unit || !wrong_unit_of_file(file, *unit, *request.unit)) return std::nullopt;
  return UnitInName{.column = request.column, .in_name = *text, .read_in = request.unit->text, .stated = true, .of_file = true};
}

std::optional<UnitInName> other_unit_in_name(RecordFile const& file, ColumnRequest const& request,
                                             std::optional<Unit> const& usual) {
  if (file.unit(request.column) || split_name(request.column)) return std::nullopt;
  auto const named = unit_behind_underscore(request.column);
  auto const word = !named && usual ? unit_of_time_name(request.column) : std::nullopt;
  std::optional<Unit> const unit = named ? unit_of_text(named->unit) : word ? unit_of_text(*word) : std::nullopt;
  std::optional<Unit> const& read_in = request.unit ? request.unit : request.declared ? request.declared : usual;
  if (!unit || !read_in || read_in->text == "-" || unit->dimension != read_in->dimension || same_unit(*unit, *read_in))
    return std::nullopt;
  return UnitInName{request.column,  unit->text, read_in->text, request.unit.has_value(), cycles_against_radians(*unit, *read_in),
                    word.has_value()};
}

}  // namespace sysid
