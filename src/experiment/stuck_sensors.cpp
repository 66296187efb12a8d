// Rows that a frozen sensor wrote are left out by ranges or emptied, numbers at the end of a sensor's range as missing ones.
#include "experiment/stuck_sensors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/text/words.hpp"
#include "data/cell/stuck_sensor.hpp"
#include "experiment/column_in_file.hpp"
#include "experiment/new_ranges.hpp"
#include "experiment/placeholders.hpp"

namespace sysid {
namespace {

/// Of a short part the cells are emptied, so that the simulation goes on through it; else the rows of the task before and after are
/// used. The first of the equal samples is one that the sensor measured.
std::string samples_without(FrozenRun const& run, ExperimentData const& data, DataBlock const& block, std::string const& column) {
  constexpr int fewest = 10;
  constexpr std::size_t small_part = 10;
  Experiment const& experiment = data.experiment;
  if (run.samples * small_part < experiment.time.size())
    return fmt::format("if so, empty the cells of column `{}` in rows {} to {} in the file: these samples are then not scored",
                       column, experiment.first_row + static_cast<int>(run.first) + 1,
                       experiment.first_row + static_cast<int>(run.last));
  auto const row = [&](std::size_t index) { return experiment.first_row + static_cast<int>(index); };
  auto const first = std::find(experiment.scored.begin(), experiment.scored.end(), 1);
  auto const last = std::find(experiment.scored.rbegin(), experiment.scored.rend(), 1);
  std::vector<RowRange> ranges;
  for (RowRange const each : {RowRange{row(static_cast<std::size_t>(first - experiment.scored.begin())), row(run.first)},
                              RowRange{row(run.last) + 1, row(static_cast<std::size_t>(experiment.scored.rend() - last)) - 1}})
    if (each.last - each.first + 1 >= fewest) ranges.push_back(each);
  return ranges.empty() ? "use another record" : "if so, " + new_ranges(block, data.use.part, ranges);
}

/// Whether the model says where the channel ends, as in `normal(min(level, rim), sd = s)`.
bool has_own_end(Model const& model, Channel const& channel) {
  std::vector<NodeId> const nodes = model.graph.reachable(channel.noise.arguments);
  return std::any_of(nodes.begin(), nodes.end(), [&](NodeId id) {
    Operation const operation = model.graph[id].operation;
    return operation == Operation::minimum || operation == Operation::maximum || operation == Operation::select;
  });
}

/// "at its largest value, 1.2 mm, in 50 samples".
std::string ends_text(std::vector<ClippedSamples> const& ends, ColumnInFile const& in_file) {
  std::string text;
  for (ClippedSamples const& end : ends)
    text += fmt::format("{} its {} value, {}, in {} samples", text.empty() ? "at" : " and at", end.largest ? "largest" : "smallest",
                        in_file.text(end.value), end.places.size());
  return text;
}

std::vector<double> numbers_of(std::vector<ClippedSamples> const& ends, ColumnInFile const& in_file) {
  std::vector<double> numbers;
  for (ClippedSamples const& end : ends) numbers.push_back(in_file.value(end.value));
  return numbers;
}

}  // namespace

Findings find_stuck_sensors(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  if (model.dynamics == Dynamics::none) return {};
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  Experiment const& experiment = data.experiment;
  Findings findings;
  for (DataMeasureUse const& column : block.measured)
    for (std::size_t c = 0; c < model.channels.size(); ++c) {
      Channel const& channel = model.channels[c];
      if (channel.name != column.channel || (channel.noise.row != nullptr && channel.noise.row->discrete)) continue;
      std::vector<double> values = experiment.measured[c];
      for (std::size_t i = 0; i < values.size(); ++i)
        if (!experiment.is_scored(c, i)) values[i] = std::nan("");
      ColumnInFile const in_file(data, column, channel);
      std::string const subject = fmt::format("{}, column `{}` of {},", channel.name, column.column, experiment.name);
      auto const clipped = has_own_end(model, channel) ? std::vector<ClippedSamples>() : clipped_samples(values);
      auto const run = frozen_run(values);
      if (!clipped.empty())  // first: a long part at an end of the range is both
        findings.push_back(
            {FindingCode::sensor_stuck,
             Severity::warning,
             {channel.name, experiment.name},
             fmt::format("{} stays {}, in runs of three or more: it may be clipped", subject, ends_text(clipped, in_file)),
             fmt::format("if the range of the sensor ended there, {}: these samples are then not scored",
                         to_be_missing(block, data, model, column.column, numbers_of(clipped, in_file)))});
      else if (run && !has_own_end(model, channel))
        findings.push_back(
            {FindingCode::sensor_stuck,
             Severity::warning,
             {channel.name, experiment.name},
             fmt::format("{} is {} in all {} samples of rows {} to {}, but changes from sample to sample elsewhere: the sensor may "
                         "have been stuck",
                         subject, in_file.text(run->value), run->samples, experiment.first_row + static_cast<int>(run->first),
                         experiment.first_row + static_cast<int>(run->last)),
             samples_without(*run, data, block, column.column)});
    }
  return findings;
}

}  // namespace sysid
