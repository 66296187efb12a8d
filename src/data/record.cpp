// Columns to SI numbers, with every doubt an error that names its row; and the cutting of experiments.
#include "data/record.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "data/file_errors.hpp"
#include "data/rounded_times.hpp"
#include "data/table.hpp"
#include "data/table_record.hpp"

namespace sysid {
namespace {

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

data_errors::Cell cell(Table const& table, std::size_t index, std::string const& column) {
  int const row = static_cast<int>(index) + 1;
  return {table.name(), table.rows_before() + row, table.line(row), column};
}

/// A column without gaps, as its numbers stand there; what: "an input", "the time".
std::vector<double> complete(Table const& table, ColumnRequest const& request, std::string const& what) {
  std::vector<double> values = table.numbers(request.column, request.mention);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::isnan(values[i])) throw UserError(data_errors::missing_value(cell(table, i, request.column), what, request.mention));
  return values;
}

std::vector<double> times(Table const& table, RecordRequest const& request, bool whole) {
  if (!request.time) {
    std::vector<double> time(static_cast<std::size_t>(table.rows()));
    for (std::size_t i = 0; i < time.size(); ++i)
      time[i] = request.step > 0 ? static_cast<double>(i) * request.step : static_cast<double>(i + 1);  // a running sum would drift
    return time;
  }
  std::vector<double> const written = complete(table, *request.time, "the time");
  std::vector<double> time = written;
  to_si(time, *request.time);
  for (std::size_t i = 1; i < time.size() && !request.independent_rows; ++i)
    if (!(time[i] > time[i - 1]))
      throw UserError(
          data_errors::time_not_increasing(cell(table, i, request.time->column), time[i - 1], time[i], request.time->mention));
  if (whole && !request.independent_rows && time.size() > 2 && unequal_step(time) > 0)
    if (std::optional<std::vector<double>> equal = equal_times_before_rounding(written)) {
      time = std::move(*equal);
      to_si(time, *request.time);
    }
  return time;
}

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

}  // namespace

std::optional<Record> load(RecordRequest const& request, Diagnostics& diagnostics) {
  std::optional<Table> const table = collect(diagnostics, request.mention, [&] {
    Table read = Table::read(request.path, request.mention, request.shown_path);
    if (read.rows() < 2) throw UserError(data_errors::too_few_rows(read.name(), read.rows(), request.mention));
    return read;
  });
  return table ? read_record(request, *table, diagnostics, true) : std::nullopt;
}

std::optional<Record> read_record(RecordRequest const& request, Table const& table, Diagnostics& diagnostics, bool whole) {
  if (!request.time && !(request.step > 0) && !request.independent_rows)
    throw InternalError("a record without a time column needs a step");
  bool complete_record = true;
  Record record;
  record.path = request.shown_path.empty() ? request.path : request.shown_path;
  record.digest = table.digest();
  record.comments = table.comments();
  std::optional<std::vector<double>> time = collect(diagnostics, request.mention, [&] { return times(table, request, whole); });
  if (!time) complete_record = false;
  // Inputs of independent rows are read at rows alone.
  std::vector<double> rows(static_cast<std::size_t>(table.rows()));
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = static_cast<double>(i + 1);
  for (InputRequest const& input : request.inputs) {
    std::optional<std::vector<double>> samples = collect(diagnostics, input.mention, [&] {
      std::vector<double> values = complete(table, input, "an input");
      to_si(values, input);
      return values;
    });
    std::optional<InputSignal> signal;
    if (samples && time)
      signal = collect(diagnostics, input.mention,
                       [&] { return InputSignal(input.rule, request.independent_rows ? rows : *time, std::move(*samples)); });
    if (signal)
      record.inputs.push_back(std::move(*signal));
    else
      complete_record = false;
  }
  for (std::optional<ColumnRequest> const& channel : request.measured) {
    std::optional<std::vector<double>> samples;
    if (!channel)
      samples.emplace();
    else
      samples = collect(diagnostics, channel->mention, [&] {
        std::vector<double> values = table.numbers(channel->column, channel->mention);
        if (channel->counts)
          for (std::size_t i = 0; i < values.size(); ++i)
            if (values[i] < 0 || values[i] != std::floor(values[i]) || std::isinf(values[i]))
              if (!std::isnan(values[i]))
                throw UserError(data_errors::not_a_count(cell(table, i, channel->column), values[i], channel->mention));
        to_si(values, *channel);
        return values;
      });
    if (samples)
      record.measured.push_back(std::move(*samples));
    else
      complete_record = false;
  }
  if (!complete_record) return std::nullopt;
  record.time = std::move(*time);
  if (request.time) record.time_unit = request.time->unit;
  return record;
}

double measured_sample(Experiment const& experiment, int channel, int row) {
  auto const c = static_cast<std::size_t>(channel);
  std::vector<double> const& measured = experiment.measured[c];
  double const missing = std::nan("");
  if (row >= 0) return measured.empty() ? missing : measured[static_cast<std::size_t>(row)];
  auto const back = static_cast<std::size_t>(-row - 1);
  return c < experiment.history.size() && back < experiment.history[c].size() ? experiment.history[c][back] : missing;
}

std::optional<Diagnostic> check_rows(Record const& record, std::string const& what, RowRange rows, std::optional<Span> mention) {
  int const last = rows.last == 0 ? record.rows() : rows.last;
  if (rows.first >= 1 && rows.first <= last && last <= record.rows()) return std::nullopt;
  return data_errors::rows_outside(record.path, what, rows.first, last, record.rows(), mention);
}

Experiment make_experiment(Record const& record, std::string name, int simulate_from, RowRange scored,
                           std::optional<Span> mention) {
  if (std::optional<Diagnostic> wrong = check_rows(record, fmt::format("`{}`", name), scored, mention))
    throw UserError(std::move(*wrong));
  if (simulate_from < 1 || simulate_from > scored.first)
    throw InternalError("a simulation starts after the first row it is scored on");
  int const last = scored.last == 0 ? record.rows() : scored.last;
  int const begin = simulate_from - 1;
  Experiment experiment;
  experiment.name = std::move(name);
  experiment.first_row = simulate_from;
  experiment.time_unit = record.time_unit;
  experiment.time.assign(record.time.begin() + begin, record.time.begin() + last);
  for (InputSignal const& input : record.inputs) experiment.inputs.push_back(input.view(begin, last - begin));
  for (std::vector<double> const& channel : record.measured) {
    if (channel.empty())
      experiment.measured.emplace_back();
    else
      experiment.measured.emplace_back(channel.begin() + begin, channel.begin() + last);
    std::vector<double> before(channel.begin(), channel.begin() + (channel.empty() ? 0 : begin));
    std::reverse(before.begin(), before.end());
    experiment.history.push_back(std::move(before));
  }
  experiment.scored.assign(static_cast<std::size_t>(last - begin), 0);
  std::fill(experiment.scored.begin() + (scored.first - simulate_from), experiment.scored.end(), std::uint8_t{1});
  return experiment;
}

}  // namespace sysid
