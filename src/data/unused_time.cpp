// A time that the data block does not use is the only thing in a file that shows a wrong rate, and rows that are not there.
#include "data/unused_time.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "data/cell/column_name.hpp"
#include "data/cell/rounded_times.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_doubt.hpp"
#include "data/cell/time_stamp.hpp"
#include "data/cell/unit_text.hpp"
#include "data/record.hpp"
#include "data/table/proposal.hpp"
#include "data/table/table.hpp"

namespace sysid {
namespace {

/// A column that has the time, and how it is read.
struct Times {
  std::string column, lines;
  std::vector<double> seconds;
  double unit = 0;       // s, of the last digit
  bool assumed = false;  // nothing says that its numbers are seconds
  bool whole = false;    // its numbers
};

bool rise(std::vector<double> const& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) || (i > 0 && !(values[i] > values[i - 1]))) return false;
  return values.size() > 2;
}

Times in_unit(std::string const& column, std::vector<double> const& values, Unit const& unit) {
  Times times{column, fmt::format("`time {}`", column_text(column, unit.text)), {}};
  for (double const value : values) times.seconds.push_back((value - values.front()) * unit.scale);
  times.unit = last_digit(values) * unit.scale;
  times.whole = std::all_of(values.begin(), values.end(), [](double value) { return value == std::floor(value); });
  return times;
}

class Finder {
 public:
  Finder(RecordFile const& file, RecordRequest const& request)
      : file_(file), request_(request), table_(dynamic_cast<Table const*>(&file)) {}

  std::optional<UnusedTime> run() {
    auto times = with_stamps();
    if (!times) times = named();
    if (times) return against(*times, UnusedTime::Kind::other_rate);
    times = of_equal_steps();
    auto found = times ? against(*times, UnusedTime::Kind::by_steps) : std::nullopt;
    // In other units it would agree: then it is the time, and nothing is wrong.
    return found && found->kind == UnusedTime::Kind::by_steps ? found : std::nullopt;
  }

 private:
  bool is_measured(std::string const& column) const {
    return std::any_of(request_.measured.begin(), request_.measured.end(),
                       [&](auto const& channel) { return channel && channel->column == column; });
  }
  bool is_input(std::string const& column) const {
    return std::any_of(request_.inputs.begin(), request_.inputs.end(), [&](auto const& input) { return input.column == column; });
  }

  /// Empty where they are no rising numbers.
  std::vector<double> numbers(std::string const& column) const {
    try {
      std::vector<double> values = file_.numbers(column);
      return rise(values) ? values : std::vector<double>();
    } catch (UserError const&) {
      return {};
    }
  }

  /// The text with other rules, where all of the column can be read by them.
  std::optional<Times> by_rules(std::string const& column, ReadingRules const& rules) const {
    try {
      Table const table = Table::parse_as_told(table_->name(), table_->bytes(), rules);
      Times times{column, fmt::format("`{}` and `time {}`", reading_statement(rules), column_text(column, "")),
                  table.times(column)};
      if (!rise(times.seconds)) return std::nullopt;
      times.unit = last_digit(times.seconds);
      return times;
    } catch (UserError const&) {
      return std::nullopt;
    }
  }

  std::optional<Times> with_stamps() const {
    if (table_ == nullptr) return std::nullopt;
    for (std::size_t c = 0; c < file_.columns().size(); ++c) {
      std::string const& column = file_.columns()[c];
      std::vector<std::string> const first = column.empty() ? std::vector<std::string>() : table_->texts(static_cast<int>(c), 1);
      if (first.empty() || !(is_time_stamp(first.front()) || read_duration(first.front()))) continue;
      ReadingRules const& rules = request_.rules;
      if (!rules.stamp.empty())
        if (auto times = by_rules(column, rules)) return times;
      auto const proposal = propose(table_->bytes(), rules, {.time = column});
      if (!proposal || proposal->rules.empty() || proposal->rules.front().stamp.empty()) continue;
      if (auto times = by_rules(proposal->time.empty() ? column : proposal->time, proposal->rules.front())) return times;
    }
    return std::nullopt;
  }

  /// What the file or the name says; nothing where neither does.
  std::optional<Unit> stated_unit(std::string const& column) const {
    if (auto const text = file_.unit(column)) return unit_of_text(*text);
    if (auto const split = split_name(column)) return unit_of_text(split->unit);
    if (auto const ended = unit_behind_underscore(column)) return unit_of_text(ended->unit);
    return std::nullopt;
  }

  std::optional<Times> read(std::string const& column) const {
    Unit const second = unit_atom("s").value();
    std::optional<Unit> const stated = stated_unit(column);
    if (stated && stated->dimension != second.dimension) return std::nullopt;
    std::vector<double> const values = numbers(column);
    if (values.empty()) return std::nullopt;
    Unit const unit = stated.value_or(second);
    if (unit.scale == 1) {
      std::string stamp;
      if (SerialTime const* const counts = seems_serial(values, column)) {
        if (table_ == nullptr) return in_unit(column, values, unit_atom(counts->unit).value());
        stamp = counts->word;
      } else if (ClockDoubt const doubt = seems_clock(values, true); table_ != nullptr && !doubt.patterns.empty()) {
        stamp = doubt.patterns.front();
      }
      if (!stamp.empty()) {
        ReadingRules rules = request_.rules;
        rules.stamp = stamp;
        std::replace(rules.stamp.begin(), rules.stamp.end(), '.', rules.decimal);
        if (auto times = by_rules(column, rules)) return times;
      }
    }
    Times times = in_unit(column, values, unit);
    times.assumed = !stated;
    return times;
  }

  std::optional<Times> named() const {
    std::optional<Times> temperature;  // by its name; a time if its steps are equal
    for (std::string const& column : file_.columns()) {
      if (column.empty() || !is_time_name(column) || is_measured(column)) continue;
      auto times = read(column);
      if (!times) continue;
      if (!is_temperature_name(column)) return times;
      if (!temperature && !is_input(column) && has_equal_steps(times->seconds)) temperature = std::move(times);
    }
    return temperature;
  }

  /// As `sysid data` finds it: no count of rows, and no other column like it.
  std::optional<Times> of_equal_steps() const {
    constexpr std::size_t fewest = 20;
    std::optional<Times> only;
    for (std::string const& column : file_.columns()) {
      if (column.empty() || is_measured(column) || is_input(column)) continue;
      if (auto const unit = stated_unit(column); unit && unit->dimension != unit_atom("s").value().dimension) continue;
      std::vector<double> const values = numbers(column);
      if (values.size() < fewest || !has_equal_steps(values)) continue;
      double const step = (values.back() - values.front()) / static_cast<double>(values.size() - 1);
      if (step == 1 || only) return std::nullopt;
      only = read(column);
    }
    return only;
  }

  /// kind: what other equal steps are called.
  std::optional<UnusedTime> against(Times const& times, UnusedTime::Kind kind) const {
    auto found = differs(times.seconds, times.unit, times);
    if (!found) return std::nullopt;
    if (times.assumed)
      for (char const* const other : {"ms", "us", "ns", "min", "h", "d", "week", "year"}) {
        Unit const unit = unit_atom(other).value();
        std::vector<double> scaled = times.seconds;
        for (double& each : scaled) each *= unit.scale;
        if (differs(scaled, times.unit * unit.scale, times)) continue;
        // Whole numbers are counts of it, as recorders write them.
        if (times.whole) return std::nullopt;
        found->kind = UnusedTime::Kind::other_units;
        found->meant_unit = unit.text;
        found->lines = fmt::format("`time {}`", column_text(times.column, unit.text));
        return found;
      }
    if (found->kind == UnusedTime::Kind::other_rate) found->kind = kind;
    return found;
  }

  /// unit: s, of the last digit.
  std::optional<UnusedTime> differs(std::vector<double> const& seconds, double unit, Times const& times) const {
    constexpr double digit = 1.05, step_off = 0.1, rate_off = 1e-3, gap = 1.5, many = 0.1, few = 0.01;
    double const wanted = request_.step;
    double low = 0, high = 0;  // of t_i - t_0 - i h
    for (std::size_t i = 0; i < seconds.size(); ++i) {
      double const off = seconds[i] - seconds[0] - static_cast<double>(i) * wanted;
      low = std::min(low, off);
      high = std::max(high, off);
    }
    if (high - low <= std::max(digit * unit, step_off * wanted)) return std::nullopt;
    std::vector<double> steps;
    for (std::size_t i = 1; i < seconds.size(); ++i) steps.push_back(seconds[i] - seconds[i - 1]);
    std::vector<double> sorted = steps;
    std::sort(sorted.begin(), sorted.end());
    double const median = sorted[sorted.size() / 2];
    UnusedTime found{UnusedTime::Kind::other_rate, times.column, times.lines, median, sorted.front(), sorted.back()};
    found.row = static_cast<std::size_t>(std::max_element(steps.begin(), steps.end()) - steps.begin()) + 1;
    double sum = 0;  // of the steps that are no gaps
    std::size_t unequal = 0;
    for (double const each : steps) {
      if (each > gap * median && each > median + gap * unit) {
        ++found.gaps;
        continue;
      }
      sum += each;
      unequal += std::fabs(each - median) > std::max(step_off * median, gap * unit) ? 1 : 0;
    }
    auto const all = static_cast<double>(steps.size()), alike = all - static_cast<double>(found.gaps);
    found.step = sum / alike;
    found.kind = UnusedTime::Kind::unequal;
    if (static_cast<double>(unequal + found.gaps) > many * all) return found;
    found.kind = UnusedTime::Kind::other_rate;
    if (std::fabs(found.step - wanted) > rate_off * wanted + unit * static_cast<double>(found.gaps + 1) / alike) return found;
    found.kind = UnusedTime::Kind::gap;
    if (found.gaps > 0) return found;
    found.kind = UnusedTime::Kind::unequal;
    double const wander = std::max({rate_off * all * wanted, wanted / 2, digit * unit});
    if (static_cast<double>(unequal) > few * all || high - low > wander) return found;
    return std::nullopt;
  }

  RecordFile const& file_;
  RecordRequest const& request_;
  Table const* table_;
};

}  // namespace

std::optional<UnusedTime> find_unused_time(RecordFile const& file, RecordRequest const& request) {
  if (request.time || !(request.step > 0) || request.independent_rows) return std::nullopt;
  return Finder(file, request).run();
}

std::string find_measured_time(RecordFile const& file, RecordRequest const& request) {
  for (std::optional<ColumnRequest> const& channel : request.measured) {
    if (!channel || !is_time_name(channel->column) || is_temperature_name(channel->column)) continue;
    std::optional<Unit> const& unit = channel->declared ? channel->declared : channel->unit;
    if (unit && unit->dimension == unit_atom("s").value().dimension) continue;
    try {
      std::vector<double> const values = file.numbers(channel->column);
      if (rise(values) && has_equal_steps(values)) return channel->column;
    } catch (UserError const&) {
      continue;
    }
  }
  return {};
}

std::vector<std::string> find_unused_columns(RecordFile const& file, RecordRequest const& request) {
  std::vector<std::string> used, unused;
  if (request.time) used.push_back(request.time->column);
  for (InputRequest const& input : request.inputs) used.push_back(input.column);
  for (std::optional<ColumnRequest> const& channel : request.measured)
    if (channel) used.push_back(channel->column);
  for (std::string const& column : file.columns())
    if (!column.empty() && std::find(used.begin(), used.end(), column) == used.end()) unused.push_back(column);
  return unused;
}

}  // namespace sysid
