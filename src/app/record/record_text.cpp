// For people: time, columns, remarks, and the data block.
#include "app/record/record_text.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

std::string with_unit(double value, std::string const& unit) {
  return significant(value, 4) + (unit.empty() || unit == "-" ? "" : " " + unit);
}

/// Without zeros at the end.
std::string six_digits(double value) { return fmt::format("{:.6g}", value); }

std::string time_line(RecordLook const& look) {
  TimeLook const& time = look.time;
  if (time.column.empty()) return "time      not found in any column\n";
  std::string out =
      fmt::format("time      `{}`{}{}{}: {} s to {} s, ", time.column, time.stamps || time.since_first ? ", dates and times" : "",
                  time.by_steps ? ", the only column of equal steps" : "", time.assumed ? ", unit assumed: s" : "",
                  six_digits(time.first), six_digits(time.last));
  if (time.step > 0) out += fmt::format("{} Hz ({} s), ", six_digits(1 / time.step), six_digits(time.step));
  if (time.rounded)
    out += fmt::format("equal steps, rounded to {:.4g} s", time.rounded->unit);
  else if (time.unequal == 0)
    out += "equal steps";
  else
    out += fmt::format("{} not equal to the others", counted(time.unequal, "step"));
  if (time.gaps > 0)
    out += fmt::format("; {}, the longest of {} s before row {}", counted(time.gaps, "gap"), significant(time.longest_gap, 4),
                       time.longest_gap_row);
  return out + "\n";
}

/// What may be wrong with a column, one sentence each.
std::vector<std::string> remarks(ColumnLook const& column) {
  std::vector<std::string> all;
  if (!column.unread.empty()) return {column.unread};
  if (column.dead) all.push_back(fmt::format("is {} in all rows: a dead channel", six_digits(column.smallest)));
  if (column.unit == "g" || column.unit == "mg" || column.unit == "ug")
    all.push_back(fmt::format("is read as a mass, [{0}]; if it is an acceleration, write `[{0}_n]`", column.unit));
  if (column.missing > 0) all.push_back(fmt::format("misses {}", counted(column.missing, "sample")));
  if (column.frozen_first > 0)
    all.push_back(fmt::format("does not change in rows {} to {}, but from sample to sample elsewhere: frozen?", column.frozen_first,
                              column.frozen_last));
  for (auto const& [count, end, value] :
       {std::tuple(column.at_largest, "largest", column.largest), std::tuple(column.at_smallest, "smallest", column.smallest)})
    if (count > 0)
      all.push_back(fmt::format("stays at its {} value, {}, for {}: clipped?", end, six_digits(value), counted(count, "sample")));
  if (column.quantum > 0 && !column.dead && column.levels * 4 < column.rows)
    all.push_back(fmt::format("moves in steps of {}: {} different numbers", significant(column.quantum, 4), column.levels));
  if (column.drift != 0)
    all.push_back(fmt::format("drifts by {} from the first row to the last", with_unit(column.drift, column.unit)));
  if (!column.peaks.empty()) {
    std::string text = "oscillates at ";
    for (std::size_t i = 0; i < column.peaks.size(); ++i)
      text += fmt::format("{}{} Hz (amplitude {})", i == 0 ? "" : ", ", significant(column.peaks[i].frequency, 4),
                          with_unit(column.peaks[i].amplitude, column.unit));
    all.push_back(text);
  }
  return all;
}

}  // namespace

std::string record_text(RecordLook const& look) {
  std::string out =
      fmt::format("{}: {}, {}, {}\n", look.file, look.format, counted(look.columns.size(), "column"), counted(look.rows, "row"));
  out += time_line(look) + "\n";
  std::vector<std::vector<std::string>> rows = {{"column", "unit", "numbers", "smallest", "largest", "mean", "sd"}};
  for (ColumnLook const& column : look.columns) {
    if (!column.unread.empty()) {
      rows.push_back({column.name, column.unit, std::to_string(column.rows), "", "", "", ""});
      continue;
    }
    rows.push_back({column.name, column.unit, std::to_string(column.rows - column.missing), significant(column.smallest, 4),
                    significant(column.largest, 4), significant(column.mean, 4), significant(column.sd, 3)});
  }
  out += align_columns(rows, 2);
  std::string said;
  for (ColumnLook const& column : look.columns) {
    if (column.name == look.time.column) continue;
    for (std::string const& remark : remarks(column)) said += fmt::format("`{}` {}\n", column.name, remark);
  }
  for (UnreadVariable const& each : look.left_out) said += fmt::format("`{}` {}\n", each.name, each.reason);
  if (!said.empty()) out += "\n" + said;
  if (look.lines_below > 0)
    out +=
        fmt::format("\n{} below the table {} left out\n", counted(look.lines_below, "line"), look.lines_below == 1 ? "is" : "are");
  if (!look.question.empty())
    out += fmt::format("\n{}: the first is used here; choose between {}\n", look.question, quoted(look.readings, "and"));
  return out + "\n" + look.block;
}

}  // namespace sysid
