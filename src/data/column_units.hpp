// In which unit the numbers of a column are: by the data block, by the file, by the name of the column. Where two of them
// contradict each other, that is an error or a finding.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "core/numeric/unit.hpp"
#include "data/record.hpp"
#include "data/table/record_file.hpp"

namespace sysid {

/// Numbers of a column, converted to the declared unit and then to SI.
void to_si(std::vector<double>& values, ColumnRequest const& request);

/// Whether numbers need no change to be in the other unit: a difference of temperatures may have either name, and 3000 rpm are
/// 3000 1/min.
bool same_unit(Unit const& a, Unit const& b);

/// The unit that the file states becomes that of the request if the data block gives none. UserError where the two differ.
void take_unit_of_file(RecordFile const& file, ColumnRequest& request);

/// UserError for `F [kN]` without a unit in the data block, whose numbers would be read in another unit of the model.
void refuse_unit_left_out(RecordFile const& file, std::string const& column, Unit const& read_in, std::optional<Span> mention);

/// The file states a unit of another kind of quantity than the data block, whose unit is used.
std::optional<UnitInName> wrong_unit_in_file(RecordFile const& file, ColumnRequest const& request);

/// Another unit in the name of a column for which neither the file nor brackets in its name state one. usual: of the time, whose
/// name may be a unit in a word.
std::optional<UnitInName> other_unit_in_name(RecordFile const& file, ColumnRequest const& request,
                                             std::optional<Unit> const& usual);

}  // namespace sysid
