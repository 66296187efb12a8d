// What loggers and spreadsheets write where a sensor gave nothing, as far as it has not been asked about when the file was read.
#include "experiment/placeholders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "data/cell/doubtful_number.hpp"
#include "data/cell/dropped_samples.hpp"
#include "data/cell/stuck_sensor.hpp"
#include "data/table/reading_rules.hpp"
#include "experiment/column_in_file.hpp"

namespace sysid {
namespace {

std::string missing_with(ReadingRules const& rules, std::vector<double> const& values) {
  std::vector<std::string> marks = rules.missing;
  for (double const value : values) {
    marks.push_back(fmt::format("{:.12g}", value));
    std::replace(marks.back().begin(), marks.back().end(), '.', rules.decimal);
  }
  std::string list;
  for (std::string const& each : marks) list += (list.empty() ? "" : ", ") + quoted_text(each);
  if (rules.no_other_mark) list += ", none";
  if (marks.size() > 1 || rules.no_other_mark) list = "(" + list + ")";
  return rules.asked_for_missing ? fmt::format("write `missing = {}` after `read`", list)
                                 : fmt::format("write `read missing = {}`", list);
}

bool has_number(std::vector<double> const& values, double number) {
  constexpr double rounding = 1e-12;
  return std::any_of(values.begin(), values.end(),
                     [&](double value) { return std::fabs(value - number) <= rounding * std::fabs(number); });
}

/// Whether the numbers of another channel have the mark for the same reason: then both mean it.
bool is_mark_of(std::vector<double> const& values, double number) {
  for (DoubtfulNumber const& each : doubtful_numbers(values))
    if (has_number({each.value}, number)) return true;
  for (ClippedSamples const& each : clipped_samples(values))
    if (has_number({each.value}, number)) return true;
  return number == 0 && !dropped_samples(values).empty();
}

/// Another column of the record that has one of these numbers, as the time, an input, or a sample that is none of the marks.
std::string column_that_has(DataBlock const& block, ExperimentData const& data, Model const& model, std::string const& marked,
                            std::vector<double> const& numbers) {
  auto const has_one = [&](std::vector<double> const& values) {
    return std::any_of(numbers.begin(), numbers.end(), [&](double number) { return has_number(values, number); });
  };
  if (block.time) {
    std::vector<double> times = data.record.time;
    for (double& time : times) time /= data.record.time_unit ? data.record.time_unit->scale : 1;
    if (has_one(times)) return block.time->column;
  }
  for (DataInputUse const& column : block.inputs)
    for (std::size_t i = 0; i < model.inputs.size(); ++i) {
      if (model.inputs[i].name != column.input) continue;
      std::vector<double> values;
      for (int row = 0; row < data.record.inputs[i].rows(); ++row) values.push_back(data.record.inputs[i].sample(row));
      if (has_one(ColumnInFile(data, column, model.inputs[i]).values(std::move(values)))) return column.column;
    }
  for (DataMeasureUse const& column : block.measured)
    for (std::size_t c = 0; c < model.channels.size() && column.column != marked; ++c) {
      if (model.channels[c].name != column.channel) continue;
      std::vector<double> const values = ColumnInFile(data, column, model.channels[c]).values(data.record.measured[c]);
      for (double const number : numbers)
        if (has_number(values, number) && !is_mark_of(values, number)) return column.column;
    }
  return {};
}

}  // namespace

std::string to_be_missing(DataBlock const& block, ExperimentData const& data, Model const& model, std::string const& column,
                          std::vector<double> const& numbers) {
  std::string const other = column_that_has(block, data, model, column, numbers);
  if (other.empty()) return missing_with(block.rules, numbers) + " in the data block";
  return fmt::format("empty these cells of column `{}` in the file (`missing` would remove such numbers from column `{}`, too)",
                     column, other);
}

namespace {

/// far: from what the number is.
Finding finding(ExperimentData const& data, ColumnUse const& column, std::string const& unit, DoubtfulNumber const& suspect,
                std::string const& far, std::string const& cure) {
  constexpr std::size_t most_named = 5;
  std::vector<std::string> rows;
  for (std::size_t const row : suspect.places) rows.push_back(std::to_string(data.experiment.first_row + static_cast<int>(row)));
  return {FindingCode::looks_missing,
          Severity::warning,
          {column.column, data.use.name},
          fmt::format("column `{}` of {} is {:.12g}{} in {} {}, far from {}: this may mark a missing value", column.column,
                      data.use.name, suspect.value, unit_after_number(unit), plural("row", rows.size()),
                      first_listed(rows, most_named), far),
          cure};
}

}  // namespace

Findings find_placeholders(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  if (block.rules.no_other_mark) return {};
  Experiment const& experiment = data.experiment;
  Findings findings;
  auto const look = [&](ColumnUse const& column, Quantity const& quantity, std::vector<double> values, bool input) {
    ColumnInFile const in_file(data, column, quantity);
    values = in_file.values(std::move(values));
    auto const find = [&](DoubtfulNumber const& suspect, std::string const& far) {
      findings.push_back(
          finding(data, column, in_file.unit_text(), suspect, far,
                  input ? "an input needs a value in every row: interpolate the missing samples in the file, or use only later "
                          "rows, with a range in `split`; if the recorder was saturated, the true values are larger"
                        : to_be_missing(block, data, model, column.column, {suspect.value}) +
                              ": the row is then not scored; if it is a sample, " +
                              (block.rules.asked_for_missing ? "add `none` to the list" : "write `read missing = none`")));
    };
    for (DoubtfulNumber const& suspect : doubtful_numbers(values)) find(suspect, "all its other numbers");
    // An input may rest at zero between blows.
    if (std::vector<std::size_t> dropped = input ? std::vector<std::size_t>() : dropped_samples(values); !dropped.empty())
      find({0, std::move(dropped)}, "the numbers of the rows beside most of them");
  };
  for (DataInputUse const& column : block.inputs)
    for (std::size_t i = 0; i < model.inputs.size(); ++i) {
      if (model.inputs[i].name != column.input) continue;
      std::vector<double> values;
      for (int row = 0; row < experiment.inputs[i].rows(); ++row) values.push_back(experiment.inputs[i].sample(row));
      look(column, model.inputs[i], std::move(values), true);
    }
  bool const goes_on = model.dynamics == Dynamics::discrete;
  for (DataMeasureUse const& column : block.measured)
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      if (model.channels[c].name != column.channel) continue;
      std::vector<double> values = experiment.measured[c];
      for (std::size_t i = 0; i < values.size(); ++i)
        if (!goes_on && experiment.scored[i] == 0) values[i] = std::nan("");
      look(column, model.channels[c], std::move(values), false);
    }
  return findings;
}

}  // namespace sysid
