#include "experiment/column_in_file.hpp"

#include <fmt/format.h>

#include <utility>

#include "core/text/number.hpp"

namespace sysid {
namespace {

/// Stated in the data block, else in the file.
std::optional<Unit> unit_in_file(ExperimentData const& data, ColumnUse const& column) {
  if (column.unit) return column.unit;
  for (auto const& [name, unit] : data.record.file_units)
    if (name == column.column) return unit;
  return std::nullopt;
}

}  // namespace

ColumnInFile::ColumnInFile(ExperimentData const& data, ColumnUse const& column, Quantity const& quantity)
    : quantity_(quantity), unit_(unit_in_file(data, column)) {}

double ColumnInFile::value(double si) const {
  if (!quantity_.unit) return unit_ ? si / unit_->scale : si;  // the numbers of its column were multiplied by this
  double const declared = quantity_.from_si(si);
  return unit_ ? convert(declared, *quantity_.unit, *unit_) : declared;
}

std::vector<double> ColumnInFile::values(std::vector<double> si) const {
  for (double& each : si) each = value(each);
  return si;
}

std::string ColumnInFile::unit_text() const { return unit_ ? unit_->text : quantity_.unit_text(); }

std::string ColumnInFile::text(double si) const { return fmt::format("{:.6g}", value(si)) + unit_after_number(unit_text()); }

}  // namespace sysid
