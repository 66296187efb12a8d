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
#include "data/table/reading_rules.hpp"

namespace sysid {

std::optional<Unit> unit_in_file(ExperimentData const& data, ColumnUse const& column) {
  if (column.unit) return column.unit;
  for (auto const& [name, unit] : data.record.file_units)
    if (name == column.column) return unit;
  return std::nullopt;
}

std::string missing_with(ReadingRules const& rules, std::vector<double> const& values) {
  std::vector<std::string> marks = rules.missing;
  for (double const value : values) {
    marks.push_back(fmt::format("{:.12g}", value));
    std::replace(marks.back().begin(), marks.back().end(), '.', rules.decimal);
  }
  std::string list;
  for (std::string const& each : marks) list += (list.empty() ? "" : ", ") + quoted_text(each);
  if (marks.size() > 1) list = "(" + list + ")";
  return rules.missing.empty() ? fmt::format("write `read missing = {}`", list)
                               : fmt::format("write `missing = {}` after `read`", list);
}

namespace {

Finding finding(ExperimentData const& data, ColumnUse const& column, std::string const& unit, DoubtfulNumber const& suspect,
                bool input, ReadingRules const& rules) {
  constexpr std::size_t most_named = 5;
  std::vector<std::string> rows;
  for (std::size_t const row : suspect.places) rows.push_back(std::to_string(data.experiment.first_row + static_cast<int>(row)));
  return {FindingCode::looks_missing,
          Severity::warning,
          {column.column, data.use.name},
          fmt::format("column `{}` of {} is {:.12g}{} in {} {}, far from all its other numbers: a missing value?", column.column,
                      data.use.name, suspect.value, unit_after_number(unit), plural("row", rows.size()),
                      first_listed(rows, most_named)),
          input ? "an input acts at every row: interpolate the missing samples in the file, or begin after them, with a range of "
                  "rows in `split`; if a pulse saturated the recorder, the true values are larger"
                : fmt::format("{} in the data block: the row is then not scored; if it is a sample, add `none` to the list",
                              missing_with(rules, {suspect.value}))};
}

}  // namespace

Findings find_placeholders(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  if (block.rules.no_other_mark) return {};
  Experiment const& experiment = data.experiment;
  Findings findings;
  auto const look = [&](ColumnUse const& column, Quantity const& quantity, std::vector<double> values, bool input) {
    std::string unit = quantity.unit_text();
    for (double& value : values) value = quantity.from_si(value);
    if (auto const in_file = unit_in_file(data, column); in_file && quantity.unit) {
      unit = in_file->text;
      for (double& value : values) value = convert(value, *quantity.unit, *in_file);
    }
    for (DoubtfulNumber const& suspect : doubtful_numbers(values))
      findings.push_back(finding(data, column, unit, suspect, input, block.rules));
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
