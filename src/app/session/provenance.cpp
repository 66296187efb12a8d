// Notes in the user's names and units: how columns were read, and which rows count.
#include "app/session/provenance.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/system/digest.hpp"
#include "core/text/number.hpp"
#include "core/text/words.hpp"
#include "experiment/crossed_columns.hpp"
#include "experiment/dead_columns.hpp"
#include "experiment/doubtful_columns.hpp"
#include "experiment/pasted_rows.hpp"
#include "experiment/placeholders.hpp"
#include "experiment/repeated_samples.hpp"
#include "experiment/stuck_sensors.hpp"
#include "experiment/time_gaps.hpp"
#include "experiment/true_parameters.hpp"
#include "model/lags.hpp"

namespace sysid {
namespace {

// The rows that are scored, counted from 1 as in the file: "101..500, 601..700".
std::string scored_rows(Experiment const& experiment) {
  std::string text;
  auto const count = static_cast<int>(experiment.scored.size());
  for (int first = 0; first < count;) {
    if (experiment.scored[static_cast<std::size_t>(first)] == 0) {
      ++first;
      continue;
    }
    int last = first;
    while (last + 1 < count && experiment.scored[static_cast<std::size_t>(last + 1)] != 0) ++last;
    text += fmt::format("{}{}..{}", text.empty() ? "" : ", ", experiment.first_row + first, experiment.first_row + last);
    first = last + 1;
  }
  return text;
}

// SHA-256 of what the model is given beside the measured samples: of each input its column, unit and rule, and the constants of the
// experiment. Equal digests and equal files mean the same inputs.
std::string inputs_digest(DataBlock const& block, ExperimentUse const& use, Model const& model) {
  std::vector<std::string> given;
  for (Quantity const& input : model.inputs)
    for (DataInputUse const& bound : block.inputs)
      if (bound.input == input.name)
        given.push_back(fmt::format(
            "{}\n{}\n{}\n{}\n", input.name, bound.column, bound.unit ? bound.unit->text : std::string(),
            bound.rule && model.dynamics == Dynamics::continuous ? std::string(rule_name(*bound.rule)) : std::string()));
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (use.constants[p]) given.push_back(fmt::format("{}\n{}\n", model.parameters[p].name, shortest(*use.constants[p])));
  std::sort(given.begin(), given.end());  // models may declare them in any order
  return sha256(fmt::format("{}", fmt::join(given, "")));
}

DataInfo describe_data(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  DataInfo info;
  info.name = data.experiment.name;
  info.file = block.mention();
  info.sha256 = data.record.digest;
  info.rows = data.record.rows();
  info.scored = static_cast<int>(std::count(data.experiment.scored.begin(), data.experiment.scored.end(), 1));
  info.scored_rows = scored_rows(data.experiment);
  info.samples_sha256 = samples_digest(data.experiment, model);
  info.inputs_sha256 = inputs_digest(block, data.use, model);
  info.true_parameters = true_values(data.record.comments, model, data.use.name);
  for (Quantity const& input : model.inputs)
    for (DataInputUse const& use : block.inputs)
      if (use.input == input.name)
        info.notes.push_back(fmt::format(
            "input {} = {}{}{}", input.name, use.column, use.unit ? fmt::format(" [{}]", use.unit->text) : std::string(),
            use.rule && model.dynamics == Dynamics::continuous ? fmt::format(", {}", rule_name(*use.rule)) : ""));
  for (Channel const& channel : model.channels)
    for (DataMeasureUse const& use : block.measured)
      if (use.channel == channel.name)
        info.notes.push_back(
            fmt::format("{} = {}{}", channel.name, use.column, use.unit ? fmt::format(" [{}]", use.unit->text) : std::string()));
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (data.use.constants[p]) {
      Parameter const& parameter = model.parameters[p];
      std::string const unit = parameter.unit ? fmt::format(" [{}]", parameter.unit_text()) : std::string();
      info.notes.push_back(fmt::format("{} = {}{}", parameter.name, shortest(parameter.from_si(*data.use.constants[p])), unit));
    }
  if (int const history = data_lag(model); history > 0)
    info.notes.push_back(fmt::format("the first {} {} not scored: the model uses {} only as past samples", counted(history, "row"),
                                     history == 1 ? "is" : "are", history == 1 ? "it" : "them"));
  for (std::size_t c = 0; c < data.experiment.has_lags.size(); ++c) {
    std::vector<std::uint8_t> const& has_lags = data.experiment.has_lags[c];
    auto const without = std::count(has_lags.begin(), has_lags.end(), 0);
    if (without > 0)
      info.notes.push_back(
          fmt::format("{}: {} rows are not scored, because a past sample is missing", model.channels[c].name, without));
  }
  return info;
}

Findings data_findings(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  Findings all = find_placeholders(file, data, model);
  for (Findings const& more :
       {find_constant_columns(file, data, model), find_time_gaps(file, data, model), find_stuck_sensors(file, data, model),
        find_other_units(data), find_rounded_times(file, data, model), find_contradicted_rate(file, data, model),
        find_shared_columns(file, data, model), find_crossed_columns(file, data, model)})
    all.insert(all.end(), more.begin(), more.end());
  return all;
}

}  // namespace

std::string samples_digest(Experiment const& experiment, Model const& model) {
  std::vector<std::pair<std::string, std::string>> channels;  // by name: models may declare them in any order
  for (std::size_t c = 0; c < experiment.measured.size(); ++c) {
    std::string text;
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) {
      if (!experiment.is_scored(c, i)) continue;
      text += fmt::format("{} {}\n", experiment.first_row + static_cast<int>(i),
                          shortest(model.channels[c].from_si(experiment.measured[c][i])));
    }
    if (!text.empty()) channels.emplace_back(model.channels[c].name, std::move(text));
  }
  std::sort(channels.begin(), channels.end());
  std::string all;
  for (auto const& [name, text] : channels) all += name + "\n" + text;
  return sha256(all);
}

bool tells_of_data(FindingCode code) {
  return code == FindingCode::looks_missing || code == FindingCode::column_constant || code == FindingCode::time_gap ||
         code == FindingCode::sensor_stuck || code == FindingCode::times_rounded || code == FindingCode::rate_contradicted ||
         code == FindingCode::column_used_twice || code == FindingCode::samples_repeated || code == FindingCode::unit_in_name ||
         code == FindingCode::unit_in_file;
}

void look_at_data(CheckedFile const& file, ExperimentData const& data, Model const& model, Findings& findings) {
  for (Finding& each : data_findings(file, data, model))
    if (std::find(findings.begin(), findings.end(), each) == findings.end()) findings.push_back(std::move(each));
}

void look_at_all_data(CheckedFile const& file, std::vector<ExperimentData> const& data, Model const& model, Findings& findings) {
  auto const add = [&](Findings more) {
    for (Finding& each : more)
      if (std::find(findings.begin(), findings.end(), each) == findings.end()) findings.push_back(std::move(each));
  };
  for (ExperimentData const& each : data) look_at_data(file, each, model, findings);
  for (ExperimentData const& each : data) add(find_pasted_rows(file, each, model));
  add(find_repeated_samples(file, data, model));
}

void add_fitted_data(CheckedFile const& file, std::vector<ExperimentData> const& data, Model const& model, Report& report) {
  for (ExperimentData const& each : data) report.data.push_back(describe_data(file, each, model));
  look_at_all_data(file, data, model, report.findings);
}

void add_data(CheckedFile const& file, ExperimentData const& data, Model const& model, Report& report) {
  report.data.push_back(describe_data(file, data, model));
  look_at_data(file, data, model, report.findings);
}

void print_data_findings(Session& session, Task const& task, std::vector<ExperimentData> const& data, Model const& model) {
  for (ExperimentData const& each : data) print_findings(session, task, data_findings(session.file, each, model));
}

void print_findings(Session& session, Task const& task, Findings const& findings) {
  for (Finding const& each : findings)
    if (each.severity != Severity::note) session.notices << fmt::format("{}: warning: {}\n", task.name, each.message);
}

}  // namespace sysid
