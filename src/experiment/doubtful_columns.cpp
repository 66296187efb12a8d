// What the record noted when it was read, in words.
#include "experiment/doubtful_columns.hpp"

#include <fmt/format.h>

#include <string>

#include "core/text/number.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid {

Findings find_other_units(ExperimentData const& data) {
  Findings findings;
  for (UnitInName const& each : data.record.other_units)
    findings.push_back({FindingCode::unit_in_name,
                        each.stated ? Severity::note : Severity::warning,
                        {each.column, data.use.name},
                        fmt::format("column `{}` of {} is read in {}, but its name ends in {}", each.column, data.use.name,
                                    each.read_in, each.in_name),
                        fmt::format("if the name is right, write `{}` in the data block{}", column_text(each.column, each.in_name),
                                    each.stated ? "" : fmt::format("; if not, `{}`", column_text(each.column, each.read_in)))});
  return findings;
}

Findings find_rounded_times(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  std::optional<RoundedSteps> const& rounded = data.record.rounded;
  if (!rounded || model.dynamics == Dynamics::none) return {};
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  double const scale = data.record.time_unit ? data.record.time_unit->scale : 1;
  std::string const unit = data.record.time_unit ? data.record.time_unit->text : "s";
  return {{FindingCode::times_rounded,
           Severity::warning,
           {data.use.name},
           fmt::format("the steps of the time of {} are {} or {} {}, as equal steps at {} Hz are when they are rounded",
                       data.use.name, fmt::format("{:.6g}", rounded->lower / scale),
                       fmt::format("{:.6g}", (rounded->lower + rounded->unit) / scale), unit, shortest(rounded->rate)),
           fmt::format("if the samples were taken at equal steps, write `rate {} [Hz]` in place of `time` in `{}`: times that are "
                       "off by a part of a step act like noise, and bias the estimates",
                       shortest(rounded->rate), block.name)}};
}

}  // namespace sysid
