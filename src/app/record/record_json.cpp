// For programs.
#include <nlohmann/json.hpp>

#include "app/record/record_text.hpp"

namespace sysid {
namespace {

nlohmann::ordered_json json_of(ColumnLook const& column) {
  nlohmann::ordered_json out{{"name", column.name}, {"unit", column.unit}};
  if (!column.unread.empty()) {
    out["unread"] = column.unread;
    return out;
  }
  out["numbers"] = column.rows - column.missing;
  out["missing"] = column.missing;
  out["first"] = column.first;
  out["smallest"] = column.smallest;
  out["largest"] = column.largest;
  out["mean"] = column.mean;
  out["sd"] = column.sd;
  out["dead"] = column.dead;
  out["at_smallest"] = column.at_smallest;
  out["at_largest"] = column.at_largest;
  if (column.frozen_first > 0) out["frozen_rows"] = {column.frozen_first, column.frozen_last};
  out["quantum"] = column.quantum;
  out["levels"] = column.levels;
  out["drift"] = column.drift;
  out["peaks"] = nlohmann::ordered_json::array();
  for (SpectralPeak const& peak : column.peaks)
    out["peaks"].push_back({{"frequency", peak.frequency}, {"amplitude", peak.amplitude}});
  return out;
}

}  // namespace

std::string record_json(RecordLook const& look) {
  nlohmann::ordered_json out{
      {"file", look.file}, {"format", look.format}, {"rows", look.rows}, {"lines_below", look.lines_below}, {"read", look.reading}};
  if (!look.question.empty()) out["question"] = {{"text", look.question}, {"choices", look.readings}};
  TimeLook const& time = look.time;
  out["time"] = {{"column", time.column},
                 {"unit", time.unit},
                 {"unit_assumed", time.assumed},
                 {"stamps", time.stamps},
                 {"first", time.first},
                 {"last", time.last},
                 {"step", time.step},
                 {"unequal_steps", time.unequal},
                 {"gaps", time.gaps},
                 {"longest_gap", time.longest_gap},
                 {"longest_gap_row", time.longest_gap_row}};
  if (time.rounded) out["time"]["rounded"] = {{"unit", time.rounded->unit}, {"rate", time.rounded->rate}};
  out["columns"] = nlohmann::ordered_json::array();
  for (ColumnLook const& column : look.columns) out["columns"].push_back(json_of(column));
  out["left_out"] = nlohmann::ordered_json::array();
  for (UnreadVariable const& each : look.left_out) out["left_out"].push_back({{"name", each.name}, {"why", each.reason}});
  out["block"] = look.block;
  return out.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace sysid
