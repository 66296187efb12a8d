// Which column is the time, and what its steps show.
#include "data/look/record_look.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>

#include "core/numeric/unit.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "data/cell/column_name.hpp"
#include "data/cell/doubtful_number.hpp"
#include "data/cell/rounded_times.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_doubt.hpp"
#include "data/cell/unit_text.hpp"
#include "data/cell/usual_step.hpp"
#include "data/format/open_record.hpp"
#include "data/look/paste_block.hpp"
#include "data/table/encoding.hpp"
#include "data/table/file_errors.hpp"
#include "data/table/gzip.hpp"
#include "data/table/proposal.hpp"
#include "data/table/record_bytes.hpp"
#include "data/table/table.hpp"

namespace sysid {
namespace {

/// Rules for a text, and what was seen that the block states in other words.
struct Chosen {
  ReadingRules rules;
  std::vector<ReadingRules> others;          // that the question leaves open
  std::string time;                          // the column with stamps
  std::map<std::string, std::string> units;  // of a line of units, by column
};

bool keeps_increasing(std::vector<double> const& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isnan(values[i]) || (i > 0 && !(values[i] > values[i - 1]))) return false;
  return values.size() > 1;
}

Chosen choose_rules(std::string const& path, std::string const& text, RecordLook& look) {
  auto proposal = propose(text, {});
  if (!proposal) {
    if (int const line = broken_line(text)) throw UserError(data_errors::broken_table(path, line, std::nullopt));
    return {};
  }
  // Stamps are looked for in the column that has them.
  std::string time;
  Layout const& layout = proposal->layout;
  for (std::size_t c = 0; c < layout.columns.size(); ++c)
    if ((layout.looks[c] == CellLook::stamp || read_duration(layout.rows.front()[c])) && !layout.columns[c].empty()) {
      std::string const column = layout.columns[c];
      if (auto with_stamps = propose(text, {}, {.time = column}); with_stamps && !with_stamps->rules.front().stamp.empty()) {
        time = with_stamps->time.empty() ? column : with_stamps->time;
        proposal = std::move(with_stamps);
        break;
      }
    }
  std::vector<std::string> names = proposal->layout.columns;
  std::vector<std::string> sorted = names;
  std::sort(sorted.begin(), sorted.end());
  if (std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end())
    for (ReadingRules& rules : proposal->rules) rules.columns = distinct_names(names);
  Chosen chosen{proposal->rules.front(), {}, std::move(time), {}};
  // Units of a line stand in the block, where they are seen and can be changed.
  if (chosen.rules.units == UnitsPlace::line) {
    Table const table = Table::parse_as_told(path, text, chosen.rules);
    for (std::string const& column : table.columns())
      if (std::string const text = table.unit(column).value_or("");
          auto const unit = is_acceleration_name(column) ? unit_of_text(text, unit_atom("g_n").value()) : unit_of_text(text))
        chosen.units[column] = unit->text;
    for (ReadingRules& rules : proposal->rules) {
      rules.units = UnitsPlace::none;
      rules.units_line = 0;
      if (rules.first_value == 0) rules.first_value = proposal->layout.first;
    }
    chosen.rules = proposal->rules.front();
  }
  look.lines_below = lines_below(text, chosen.rules.last_value);
  look.question = proposal->question;
  chosen.others.assign(proposal->rules.begin() + 1, proposal->rules.end());
  return chosen;
}

std::string unit_in(std::string const& column, RecordFile const& file, Chosen const& chosen) {
  if (auto const known = chosen.units.find(column); known != chosen.units.end()) return known->second;
  std::optional<std::string> text = file.unit(column);
  if (!text)
    if (auto const split = split_name(column)) text = split->unit;
  if (!text)
    if (auto const ended = unit_behind_underscore(column)) text = ended->unit;
  auto unit = text ? unit_of_text(*text) : std::nullopt;
  if (is_acceleration_name(column) && text) unit = unit_of_text(*text, unit_atom("g_n").value());
  if (!unit && file.unit(column).value_or("") != "") return "-";  // a unit of the file that is none here: plain numbers
  return unit ? unit->text : std::string();
}

void look_at_time(RecordLook& look) {
  TimeLook& time = look.time;
  std::vector<double> const& t = look.times;
  time.first = t.front();
  time.last = t.back();
  time.unequal = time.gaps = 0;
  if (t.size() < 2) return;
  UsualStep const usual = usual_step(t);
  time.step = usual.step;
  time.gaps = static_cast<std::size_t>(usual.gaps);
  for (std::size_t i = 1; i < t.size(); ++i) {
    double const step = t[i] - t[i - 1];
    if (usual.is_gap(step)) {
      if (step > time.longest_gap) time.longest_gap = step, time.longest_gap_row = i + 1;
    } else if (std::fabs(step - usual.median) > 1e-3 * usual.median) {
      ++time.unequal;
    }
  }
}

class Looking {
 public:
  Looking(std::string const& path, RecordLook& look) : path_(path), look_(look) {}

  void run() {
    open();
    read_columns();
    if (!is_text()) mark_missing();
    find_time();
    for (std::size_t c = 0; c < look_.columns.size(); ++c) {
      ColumnLook& column = look_.columns[c];
      bool const equal = !look_.time.column.empty() && look_.time.unequal == 0 && look_.time.gaps == 0;
      if (!column.unread.empty()) continue;
      ColumnLook made = look_at_column(column.name, look_.values[c], equal ? look_.time.step : 0);
      made.unit = column.unit;
      column = std::move(made);
    }
    look_.reading = reading_statement(chosen_.rules);
    look_.readings = {look_.reading};
    for (ReadingRules const& each : chosen_.others) look_.readings.push_back(reading_statement(each));
    look_.block = paste_block(look_);
  }

 private:
  void open() {
    std::string bytes = read_record_bytes(path_);
    if (is_gzip(bytes)) bytes = gunzip(path_, bytes);
    FormatRow const* const format = format_of(bytes);
    look_.format = format == nullptr ? "text" : std::string(format->name);
    if (format == nullptr) {
      std::optional<Encoding> encoding = is_utf8(bytes) ? std::optional(Encoding::utf8) : likely_encoding(bytes);
      bool const marked = has_utf16_mark(bytes);
      auto const text = encoding ? to_utf8(bytes, *encoding) : std::nullopt;
      if (text) chosen_ = choose_rules(path_, *text, look_);
      if (text && *encoding != Encoding::utf8 && !marked) {
        chosen_.rules.encoding = *encoding;
        for (ReadingRules& each : chosen_.others) each.encoding = *encoding;
      }
    }
    file_ = open_record(path_, chosen_.rules);
    for (auto const& [name, reason] : file_->left_out()) look_.left_out.push_back({name, reason});
  }
  /// Columns of the usual length; those of another are no rows of the same record.
  void read_columns() {
    std::map<std::size_t, int> lengths;
    for (std::string const& name : file_->columns()) {
      ColumnLook& column = look_.columns.emplace_back();
      column.name = name;
      column.unit = unit_in(name, *file_, chosen_);
      std::vector<double>& values = look_.values.emplace_back();
      try {
        values = name.empty() ? std::vector<double>() : file_->numbers(name);
        if (name.empty()) column.unread = "has no name";
      } catch (UserError const& error) {
        column.unread = "holds no numbers";
      }
      if (column.unread.empty()) ++lengths[values.size()];
    }
    int most = 0;
    for (auto const& [length, count] : lengths)
      if (count >= most && length > 0) most = count, look_.rows = length;
    for (std::size_t c = 0; c < look_.columns.size(); ++c)
      if (look_.columns[c].unread.empty() && look_.values[c].size() != look_.rows) {
        look_.columns[c].rows = look_.values[c].size();
        look_.columns[c].unread =
            fmt::format("has {}, the other columns have {}: left out", counted(look_.values[c].size(), "number"), look_.rows);
        look_.values[c].clear();
      }
  }
  bool is_text() const { return file_->row_count().has_value(); }

  /// Numbers that stand for missing samples, which of a text are looked for in its cells.
  void mark_missing() {
    for (std::size_t c = 0; c < look_.columns.size(); ++c)
      for (DoubtfulNumber const& each : doubtful_numbers(look_.values[c])) {
        std::string mark = fmt::format("{:.12g}", each.value);
        std::vector<std::string>& marks = chosen_.rules.missing;
        if (std::find(marks.begin(), marks.end(), mark) == marks.end()) marks.push_back(std::move(mark));
      }
    if (chosen_.rules.missing.empty()) return;
    file_ = open_record(path_, chosen_.rules);
    for (std::size_t c = 0; c < look_.columns.size(); ++c)
      if (look_.columns[c].unread.empty()) look_.values[c] = file_->numbers(look_.columns[c].name);
  }

  void find_time() {
    TimeLook& time = look_.time;
    if (!chosen_.rules.stamp.empty()) {
      std::vector<double> stamps = file_->times(chosen_.time);
      if (keeps_increasing(stamps)) {
        time.column = chosen_.time;
        time.stamps = true;
        look_.times = std::move(stamps);
        look_.rows = std::max(look_.rows, look_.times.size());
        return look_at_time(look_);
      }
    }
    std::optional<std::size_t> named;
    for (std::size_t c = 0; c < look_.columns.size(); ++c) {
      ColumnLook const& column = look_.columns[c];
      if (!column.unread.empty() || !is_time_name(column.name) || !keeps_increasing(look_.values[c])) continue;
      if (!named || is_temperature_name(look_.columns[*named].name)) named = c;
    }
    if (named) return take_time(*named);
    if (auto const column = only_column_of_equal_steps()) {
      time.by_steps = true;
      return take_time(*column);
    }
    for (std::size_t i = 0; i < look_.rows; ++i) look_.times.push_back(static_cast<double>(i + 1));
  }

  void take_time(std::size_t c) {
    TimeLook& time = look_.time;
    ColumnLook const& column = look_.columns[c];
    std::vector<double> const& values = look_.values[c];
    Unit unit = unit_atom("s").value();
    auto const stated = unit_of_text(column.unit);
    time.assumed = !(stated && stated->dimension == unit.dimension);
    if (!time.assumed) unit = *stated;
    time.column = column.name;
    SerialTime const* const counts = unit.scale == 1 ? seems_serial(values, column.name) : nullptr;
    if (is_text() && unit.scale == 1 && read_stamps(column.name, stamps_of_numbers(c, counts))) {
      time.assumed = false;
      return look_at_time(look_);
    }
    // Where a file has no `read`, a unit says what its numbers count; seconds need none.
    if (counts != nullptr && !is_text() && counts->word != "seconds") {
      unit = unit_atom(counts->unit).value();
      time.since_first = true;
    }
    time.assumed = time.assumed && counts == nullptr;
    time.unit = unit.text;
    look_at_numbers(values, unit.scale);
    if (time.unequal == 0 || time.gaps > 0) return;
    if (auto const equal = equal_times_before_rounding(values))
      look_at_numbers(*equal, unit.scale);
    else if ((time.rounded = rounded_steps(values, unit.scale)))
      take_rate(time.rounded->rate);
  }
  /// In place of times that it gives when it is rounded.
  void take_rate(double rate) {
    double const first = look_.times.front();
    for (std::size_t i = 0; i < look_.times.size(); ++i) look_.times[i] = first + static_cast<double>(i) / rate;
    look_at_time(look_);
  }
  /// A ramp that is measured has no equal steps, and one that is commanded has a unit or a second one beside it. No count of rows.
  std::optional<std::size_t> only_column_of_equal_steps() const {
    constexpr std::size_t fewest = 20;
    std::optional<std::size_t> only;
    for (std::size_t c = 0; c < look_.columns.size(); ++c) {
      std::vector<double> const& values = look_.values[c];
      if (!look_.columns[c].unread.empty() || values.size() < fewest || !keeps_increasing(values)) continue;
      if (auto const unit = unit_of_text(look_.columns[c].unit); unit && unit->dimension != unit_atom("s").value().dimension)
        continue;
      if (!has_equal_steps(values)) continue;
      if (mean_step(values) == 1 || only) return std::nullopt;
      only = c;
    }
    return only;
  }

  /// What `stamp` may say of numbers that are no seconds; empty: they are.
  std::vector<std::string> stamps_of_numbers(std::size_t c, SerialTime const* counts) const {
    if (counts != nullptr) return {std::string(counts->word)};
    std::vector<std::string> patterns = seems_clock(look_.values[c], true).patterns;
    for (std::string& each : patterns) std::replace(each.begin(), each.end(), '.', chosen_.rules.decimal);
    return patterns;
  }
  /// Numbers that are stamps, where all of them can be read so. stamps: the likeliest first; empty: they are none.
  bool read_stamps(std::string const& column, std::vector<std::string> const& stamps) {
    if (stamps.empty()) return false;
    ReadingRules const numbers = chosen_.rules;
    if (!take_stamp(column, stamps.front(), chosen_.rules, &look_.times)) return false;
    file_ = open_record(path_, chosen_.rules);
    for (ReadingRules& each : chosen_.others) take_stamp(column, in_decimal(stamps.front(), numbers, each), each, nullptr);
    if (stamps.size() > 1 && look_.question.empty()) {
      look_.question = fmt::format("`{}` may have hours, minutes and seconds or hours and minutes", column);
      for (std::size_t i = 1; i < stamps.size(); ++i) {
        chosen_.others.push_back(chosen_.rules);
        chosen_.others.back().stamp = stamps[i];
      }
    }
    look_.time.stamps = look_.time.since_first = true;
    return true;
  }
  /// The stamp of the used reading, as another one that the question leaves open writes its decimals.
  static std::string in_decimal(std::string stamp, ReadingRules const& used, ReadingRules const& other) {
    std::replace(stamp.begin(), stamp.end(), used.decimal, other.decimal);
    return stamp;
  }
  /// False, and nothing changed, where the column cannot be read so. times: where they go; may be null.
  bool take_stamp(std::string const& column, std::string const& stamp, ReadingRules& rules, std::vector<double>* times) const {
    ReadingRules with_stamp = rules;
    with_stamp.stamp = stamp;
    try {
      std::vector<double> read = open_record(path_, with_stamp)->times(column);
      if (times != nullptr) *times = std::move(read);
    } catch (UserError const&) {
      return false;
    }
    rules = std::move(with_stamp);
    return true;
  }
  void look_at_numbers(std::vector<double> const& values, double scale) {
    double const from = look_.time.since_first ? values.front() : 0;
    look_.times.clear();
    for (double const value : values) look_.times.push_back((value - from) * scale);
    look_at_time(look_);
  }

  std::string const& path_;
  RecordLook& look_;
  Chosen chosen_;
  std::unique_ptr<RecordFile> file_;
};

}  // namespace

RecordLook look_at_record(std::string const& path) {
  RecordLook look;
  look.file = path;
  Looking(path, look).run();
  return look;
}

}  // namespace sysid
