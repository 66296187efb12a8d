// The columns of a file as numbers in SI units; every doubt is an error that names its row.
#include "data/record.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

#include "data/cell/column_name.hpp"
#include "data/cell/serial_time.hpp"
#include "data/cell/time_doubt.hpp"
#include "data/cell/unit_text.hpp"
#include "data/column_units.hpp"
#include "data/format/open_record.hpp"
#include "data/input_gap.hpp"
#include "data/table/cell_errors.hpp"
#include "data/table/column_unit_errors.hpp"
#include "data/table/file_errors.hpp"
#include "data/table/time_errors.hpp"
#include "data/table_record.hpp"

namespace sysid {
namespace {

/// The columns of a record as they are asked for, all of one length.
class Columns {
 public:
  Columns(RecordFile const& file, RecordRequest const& request) : file_(file), request_(request) {}

  std::vector<double> times(bool whole) {
    ColumnRequest column = *request_.time;
    std::vector<double> const written = complete(file_.times(column.column, column.mention), column, "the time");
    if (!file_.has_stamps()) {
      take_unit_of_file(file_, column);
      if (!column.unit) refuse_unit_left_out(file_, column.column, unit_atom("s").value(), column.mention);
      if (column.unit && column.unit->dimension != unit_atom("s").value().dimension)
        throw UserError(data_errors::unit_of_another_kind(file_.name(), column.column, column.unit->text, "s", column.mention));
      time_unit_ = column.unit;
      note_unit(column, unit_atom("s"));
      // Rows that arrive one by one cannot be read with `stamp`.
      if (whole && (!request_.independent_rows || request_.uses_times)) refuse_no_seconds(written, column);
    }
    auto const in_seconds = [&](std::vector<double>& time) {
      if (!file_.has_stamps()) to_si(time, column);
    };
    std::vector<double> time = written;
    in_seconds(time);
    for (std::size_t i = 1; i < time.size() && !request_.independent_rows; ++i)
      if (!(time[i] > time[i - 1]))
        throw UserError(data_errors::time_not_increasing(file_.place(i, column.column), written[i - 1], written[i],
                                                         file_.has_stamps() ? "s"
                                                         : column.unit      ? column.unit->text
                                                                            : std::string(),
                                                         column.mention));
    if (whole && !request_.independent_rows && time.size() > 2 && unequal_step(time) > 0) {
      if (std::optional<std::vector<double>> equal = equal_times_before_rounding(written)) {
        time = std::move(*equal);
        in_seconds(time);
      } else {
        rounded_ = rounded_steps(written, column.unit && !file_.has_stamps() ? column.unit->scale : 1);
      }
    }
    return time;
  }
  /// Where no column has the time.
  std::vector<double> counted_times() const {
    std::vector<double> time(file_.row_count() ? static_cast<std::size_t>(*file_.row_count()) : rows_.value_or(0));
    for (std::size_t i = 0; i < time.size(); ++i)  // a running sum would drift
      time[i] = request_.step > 0 ? static_cast<double>(i) * request_.step : static_cast<double>(i + 1);
    return time;
  }
  /// Rows that arrive one by one are used at once, so none of them may lack a value.
  std::vector<double> input(InputRequest const& asked, std::size_t index, bool whole) {
    InputRequest column = asked;
    take_unit_of_file(file_, column);
    note_unit(column);
    if (!asked.unit && column.unit) file_units_.emplace_back(column.column, *column.unit);
    std::vector<double> values = file_.numbers(column.column, column.mention);
    bool const empty = std::all_of(values.begin(), values.end(), [](double value) { return std::isnan(value); });
    values = whole && !empty ? of_one_length(std::move(values), column) : complete(std::move(values), column, "an input");
    for (InputGap& gap : bridge_gaps(values)) {
      gap.input = index;
      gap.line = file_.place(static_cast<std::size_t>(gap.first - 1), column.column).line;
      gap.column = column.column;
      gap.mention = column.mention;
      gaps_.push_back(std::move(gap));
    }
    to_si(values, column);
    return values;
  }
  std::vector<double> measured(ColumnRequest const& asked) {
    ColumnRequest column = asked;
    take_unit_of_file(file_, column);
    note_unit(column);
    if (!asked.unit && column.unit) file_units_.emplace_back(column.column, *column.unit);
    std::vector<double> values = of_one_length(file_.numbers(column.column, column.mention), column);
    for (std::size_t i = 0; i < values.size() && column.counts; ++i)
      if (!std::isnan(values[i]) && (values[i] < 0 || values[i] != std::floor(values[i]) || std::isinf(values[i])))
        throw UserError(data_errors::not_a_count(file_.place(i, column.column), values[i], column.mention));
    to_si(values, column);
    return values;
  }
  std::optional<Unit> const& time_unit() const { return time_unit_; }
  std::vector<UnitInName> const& other_units() const { return other_units_; }
  std::vector<std::pair<std::string, Unit>> const& file_units() const { return file_units_; }
  std::optional<RoundedSteps> const& rounded() const { return rounded_; }
  std::vector<InputGap> const& gaps() const { return gaps_; }

 private:
  void note_unit(ColumnRequest const& column, std::optional<Unit> const& usual = std::nullopt) {
    if (auto other = other_unit_in_name(file_, column, usual)) other_units_.push_back(std::move(*other));
    if (auto wrong = wrong_unit_in_file(file_, column)) other_units_.push_back(std::move(*wrong));
  }
  /// Numbers that count something else than the unit they are taken for.
  void refuse_no_seconds(std::vector<double> const& written, ColumnRequest const& column) const {
    refuse_counts_since_a_date(written, column);
    bool const is_text = file_.row_count().has_value();
    double const scale = column.unit ? column.unit->scale : 1;
    if (ClockDoubt doubt = seems_clock(written, is_text); !doubt.patterns.empty() && (scale == 1 || scale == 60)) {
      for (std::string& pattern : doubt.patterns)  // the sign of a fraction is that of the file
        std::replace(pattern.begin(), pattern.end(), '.', request_.rules.decimal);
      throw UserError(data_errors::times_are_clock(file_.place(doubt.place, column.column), written[doubt.place - 1],
                                                   written[doubt.place], doubt.patterns, is_text, column.mention));
    }
    if (!column.unit && !(request_.step > 0) && counts_rows(written, column.column))
      throw UserError(data_errors::times_are_counts(file_.place(0, column.column), column.mention));
  }
  void refuse_counts_since_a_date(std::vector<double> const& written, ColumnRequest const& column) const {
    std::vector<double> rising = written;
    if (request_.independent_rows) std::sort(rising.begin(), rising.end());
    SerialTime const* const counts = seems_serial(rising, column.column);
    if (counts == nullptr || (column.unit && column.unit->scale != 1)) return;
    bool const is_text = file_.row_count().has_value();
    // Seconds since 1970 are seconds; a text has digits of them that a number loses.
    if (!is_text && counts->word == "seconds") return;
    auto const split = split_name(column.column);
    auto const unit = split ? unit_of_text(split->unit) : std::nullopt;
    bool const stated = column.unit || (unit && same_unit(*unit, unit_atom("s").value()));
    if (stated && counts->word == "days") return;
    throw UserError(
        data_errors::times_are_dates(file_.place(0, column.column), written.front(), counts->word, is_text, column.mention));
  }
  std::vector<double> of_one_length(std::vector<double> values, ColumnRequest const& column) {
    if (!rows_) {
      rows_ = values.size();
      first_ = column.column;
    }
    if (*rows_ != values.size())
      throw UserError(data_errors::unequal_lengths(file_.name(), first_, *rows_, column.column, values.size(), column.mention));
    return values;
  }
  /// A column without gaps; what: "an input", "the time".
  std::vector<double> complete(std::vector<double> values, ColumnRequest const& column, std::string const& what) {
    for (std::size_t i = 0; i < values.size(); ++i)
      if (std::isnan(values[i])) throw UserError(data_errors::missing_value(file_.place(i, column.column), what, column.mention));
    return of_one_length(std::move(values), column);
  }

  RecordFile const& file_;
  RecordRequest const& request_;
  std::optional<std::size_t> rows_;
  std::string first_;  // the column that has them
  std::optional<Unit> time_unit_;
  std::vector<UnitInName> other_units_;
  std::vector<std::pair<std::string, Unit>> file_units_;
  std::optional<RoundedSteps> rounded_;
  std::vector<InputGap> gaps_;
};

/// The diagnostic of a UserError, pointing to `mention` when it points nowhere yet.
Diagnostic at(UserError const& error, std::optional<Span> mention) {
  Diagnostic diagnostic = error.diagnostic();
  if (!diagnostic.primary && mention) diagnostic.primary = Label{*mention, {}};
  return diagnostic;
}

/// Runs `read`; a UserError becomes a diagnostic, so that one wrong column does not hide the next.
template <class Read>
auto collect(Diagnostics& diagnostics, std::optional<Span> mention, Read read) -> std::optional<decltype(read())> {
  try {
    return read();
  } catch (UserError const& error) {
    diagnostics.add(at(error, mention));
    return std::nullopt;
  }
}

ColumnNeeds needs_of(RecordRequest const& request) {
  ColumnNeeds needs;
  if (request.time) {
    needs.time = request.time->column;
    needs.complete.push_back(request.time->column);
  }
  for (InputRequest const& input : request.inputs) needs.complete.push_back(input.column);
  needs.columns = needs.complete;
  for (std::optional<ColumnRequest> const& channel : request.measured)
    if (channel) needs.columns.push_back(channel->column);
  return needs;
}

/// Of independent rows, which are read where they stand. A signal has an interval, though one row has none.
InputSignal signal_of_rows(InputRule rule, std::vector<double> samples) {
  int const rows = static_cast<int>(samples.size());
  if (rows == 1) samples.push_back(samples.front());
  std::vector<double> counted;
  for (std::size_t i = 0; i < samples.size(); ++i) counted.push_back(static_cast<double>(i + 1));
  return InputSignal(rule, std::move(counted), std::move(samples)).view(0, rows);
}

/// What has a time has steps.
int fewest_rows(RecordRequest const& request) { return request.independent_rows ? 1 : 2; }

}  // namespace

std::optional<Record> load(RecordRequest const& request, Diagnostics& diagnostics) {
  std::optional<std::unique_ptr<RecordFile>> const file = collect(diagnostics, request.mention, [&] {
    std::unique_ptr<RecordFile> opened =
        open_record(request.path, request.rules, needs_of(request), request.mention, request.shown_path);
    if (auto const rows = opened->row_count(); rows && *rows < fewest_rows(request))
      throw UserError(data_errors::too_few_rows(opened->name(), *rows, fewest_rows(request), request.mention));
    return opened;
  });
  return file ? read_record(request, **file, diagnostics, true) : std::nullopt;
}

std::optional<Record> read_record(RecordRequest const& request, RecordFile const& file, Diagnostics& diagnostics, bool whole) {
  if (!request.time && !(request.step > 0) && !request.independent_rows)
    throw InternalError("a record without a time column needs a step");
  bool complete_record = true;
  Record record;
  record.path = request.shown_path.empty() ? request.path : request.shown_path;
  record.digest = file.digest();
  record.comments = file.comments();
  Columns columns(file, request);
  auto const keep = [&](auto&& read, std::optional<Span> mention) {
    auto result = collect(diagnostics, mention, read);
    complete_record = complete_record && result.has_value();
    return result;
  };
  std::optional<std::vector<double>> time;
  if (request.time) time = keep([&] { return columns.times(whole); }, request.mention);
  std::vector<std::optional<std::vector<double>>> inputs;
  for (InputRequest const& input : request.inputs)
    inputs.push_back(keep([&] { return columns.input(input, inputs.size(), whole); }, input.mention));
  for (std::optional<ColumnRequest> const& channel : request.measured) {
    auto samples = channel ? keep([&] { return columns.measured(*channel); }, channel->mention) : std::vector<double>();
    if (samples) record.measured.push_back(std::move(*samples));
  }
  if (!request.time) time = columns.counted_times();
  if (complete_record && whole && static_cast<int>(time->size()) < fewest_rows(request)) {
    diagnostics.add(
        data_errors::too_few_rows(file.name(), static_cast<int>(time->size()), fewest_rows(request), request.mention));
    return std::nullopt;
  }
  for (std::size_t i = 0; i < inputs.size() && time; ++i) {
    InputRequest const& input = request.inputs[i];
    if (!inputs[i]) continue;
    auto signal = keep(
        [&] {
          return request.independent_rows ? signal_of_rows(input.rule, std::move(*inputs[i]))
                                          : InputSignal(input.rule, *time, std::move(*inputs[i]));
        },
        input.mention);
    if (signal) record.inputs.push_back(std::move(*signal));
  }
  if (!complete_record) return std::nullopt;
  record.time = std::move(*time);
  record.time_unit = file.has_stamps() && request.time ? request.time->unit : columns.time_unit();
  record.other_units = columns.other_units();
  record.file_units = columns.file_units();
  record.rounded = columns.rounded();
  record.gaps = columns.gaps();
  record.independent_rows = request.independent_rows;
  if (whole) {
    record.unused_time = find_unused_time(file, request);
    record.measured_time = find_measured_time(file, request);
    record.unused_columns = find_unused_columns(file, request);
  }
  return record;
}

}  // namespace sysid
