// What the record noted when it was read, in words.
#include "experiment/doubtful_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>

#include "core/text/number.hpp"
#include "data/table/reading_rules.hpp"

namespace sysid {

namespace {

std::string cure_of(UnitInName const& found) {
  std::string const named = column_text(found.column, found.in_name), read = column_text(found.column, found.read_in);
  if (found.cycles)
    return fmt::format(
        "one counts cycles, the other radians: declare in the model in {} what it measures, and write the factor 2*pi "
        "where the equations need it; if the name is wrong, write `{}` in the data block",
        found.in_name, read);
  bool const has_zero_point = found.in_name == "degC" || found.in_name == "degF";
  return fmt::format(
      "if the name is right, write `{}` in the data block{}{}", named,
      has_zero_point ? fmt::format(", or `{}` if it is a difference", column_text(found.column, "delta_" + found.in_name)) : "",
      found.stated ? "" : fmt::format("; if not, `{}`", read));
}

}  // namespace

Findings find_other_units(ExperimentData const& data) {
  Findings findings;
  for (UnitInName const& each : data.record.other_units)
    findings.push_back({FindingCode::unit_in_name,
                        each.stated ? Severity::note : Severity::warning,
                        {each.column, data.use.name},
                        fmt::format("column `{}` of {} is read in {}, but its name ends in {}", each.column, data.use.name,
                                    each.read_in, each.in_name),
                        cure_of(each)});
  return findings;
}

Findings find_rounded_times(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  std::optional<RoundedSteps> const& rounded = data.record.rounded;
  if (!rounded || model.dynamics == Dynamics::none) return {};
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  // In the wrong unit the rate would be wrong, too, and with `time` the name that tells it would be gone.
  auto const is_time = [&](UnitInName const& each) { return block.time && each.column == block.time->column && !each.stated; };
  if (std::any_of(data.record.other_units.begin(), data.record.other_units.end(), is_time)) return {};
  double const scale = data.record.time_unit ? data.record.time_unit->scale : 1;
  std::string const unit = data.record.time_unit ? data.record.time_unit->text : "s";
  return {
      {FindingCode::times_rounded,
       Severity::warning,
       {data.use.name},
       fmt::format("the time steps of {} are {} or {} {}: this results if times at equal steps, {} Hz, are rounded", data.use.name,
                   fmt::format("{:.6g}", rounded->lower / scale), fmt::format("{:.6g}", (rounded->lower + rounded->unit) / scale),
                   unit, shortest(rounded->rate)),
       fmt::format("if the samples were taken at equal steps, write `rate {} [Hz]` in place of `time` in `{}`: times that are "
                   "wrong by a fraction of a step act like noise, and bias the estimates{}",
                   shortest(rounded->rate), block.name, data.experiment.time.front() == 0 ? "" : " (the time then begins at 0)")}};
}

}  // namespace sysid
