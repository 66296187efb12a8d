// A cable that came off gives a constant, which is no error of the table.
#include "experiment/dead_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "experiment/column_in_file.hpp"

namespace sysid {
namespace {

constexpr std::size_t enough_samples = 10;

/// The one number of so many values; nothing where they differ.
std::optional<double> only_number(std::vector<double> const& values) {
  if (values.size() < enough_samples) return std::nullopt;
  bool const alike = std::all_of(values.begin(), values.end(), [&](double value) { return value == values.front(); });
  return alike ? std::optional(values.front()) : std::nullopt;
}

Finding constant_channel(ExperimentData const& data, ColumnUse const& column, Channel const& channel, double value,
                         std::size_t samples) {
  return {FindingCode::column_constant,
          Severity::warning,
          {channel.name, data.experiment.name},
          fmt::format("{}, column `{}` of {}, is {} in all {} scored samples: was the sensor connected?", channel.name,
                      column.column, data.experiment.name, ColumnInFile(data, column, channel).text(value), samples),
          "check the column and the sensor; a channel that does not change gives no information about the dynamics"};
}

Finding constant_input(ExperimentData const& data, ColumnUse const& column, Quantity const& input, double value, bool whole_file) {
  return {FindingCode::column_constant,
          whole_file ? Severity::warning : Severity::note,
          {input.name, data.experiment.name},
          fmt::format("input {}, column `{}` of {}, is {} in {}{}", input.name, column.column, data.experiment.name,
                      ColumnInFile(data, column, input).text(value), whole_file ? "all rows of its file" : "all rows that are used",
                      whole_file ? ": was the sensor connected?" : ""),
          "check the column; if the input was not measured, or is a constant of the test, make it a parameter or "
          "`constant` of the model"};
}

}  // namespace

Findings find_constant_columns(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  if (model.dynamics == Dynamics::none) return {};
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  Experiment const& experiment = data.experiment;
  Findings findings;
  auto const samples_of = [](InputSignal const& signal) {
    std::vector<double> values;
    for (int row = 0; row < signal.rows(); ++row) values.push_back(signal.sample(row));
    return values;
  };
  for (DataInputUse const& column : block.inputs)
    for (std::size_t i = 0; i < model.inputs.size(); ++i) {
      if (model.inputs[i].name != column.input) continue;
      if (auto const value = only_number(samples_of(experiment.inputs[i])))
        findings.push_back(
            constant_input(data, column, model.inputs[i], *value, only_number(samples_of(data.record.inputs[i])).has_value()));
    }
  for (DataMeasureUse const& column : block.measured)
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      Channel const& channel = model.channels[c];
      if (channel.name != column.channel || (channel.noise.row != nullptr && channel.noise.row->discrete)) continue;
      std::vector<double> values;
      for (std::size_t i = 0; i < experiment.measured[c].size(); ++i)
        if (experiment.is_scored(c, i)) values.push_back(experiment.measured[c][i]);
      if (auto const value = only_number(values))
        findings.push_back(constant_channel(data, column, channel, *value, values.size()));
    }
  return findings;
}

}  // namespace sysid
