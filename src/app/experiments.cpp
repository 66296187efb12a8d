// Columns are matched to the model's inputs and channels by name, in the model's order.
#include "app/experiments.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/session.hpp"
#include "core/files.hpp"
#include "report/number.hpp"

namespace sysid {
namespace {

// Says which files of the folder have names like the one wanted.
Diagnostic unreadable(DataBlock const& block, std::filesystem::path const& path, std::string message) {
  std::vector<std::string> near;
  for (std::filesystem::path const file : files_beside(path))
    near.push_back((std::filesystem::path(block.path).parent_path() / file.filename()).string());
  std::string const guess = did_you_mean(block.path, near);
  return {Severity::error,
          "E4018",
          std::move(message),
          Label{block.path_span, {}},
          {},
          guess.empty() ? "paths are relative to the folder of the .sysid file" : guess};
}

}  // namespace

std::string_view rule_name(InputRule rule) {
  switch (rule) {
    case InputRule::zero_order:
      return "zero_order";
    case InputRule::linear:
      return "linear";
    case InputRule::cubic:
      return "cubic";
    case InputRule::band_limited:
      return "band_limited";
  }
  return "?";
}

std::string data_name(DataBlock const& block, int part) {
  return part < 0 ? block.name : block.name + "." + block.parts[static_cast<std::size_t>(part)].name;
}

Record load_record(DataBlock const& block, Model const& model, std::filesystem::path const& folder) {
  RecordRequest request;
  request.path = (folder / block.path).string();
  request.mention = block.path_span;
  request.step = block.step;
  if (block.time) request.time = ColumnRequest{block.time->column, block.time->unit, std::nullopt, block.time->span};
  for (Quantity const& input : model.inputs) {
    auto const bound =
        std::find_if(block.inputs.begin(), block.inputs.end(), [&](auto const& each) { return each.input == input.name; });
    InputRequest column;
    static_cast<ColumnRequest&>(column) = {bound->column, bound->unit, input.unit, bound->span};
    column.rule = bound->rule;
    request.inputs.push_back(std::move(column));
  }
  for (Channel const& channel : model.channels) {
    auto const bound =
        std::find_if(block.measured.begin(), block.measured.end(), [&](auto const& each) { return each.channel == channel.name; });
    if (bound == block.measured.end())
      request.measured.emplace_back();
    else
      request.measured.push_back(ColumnRequest{bound->column, bound->unit, channel.unit, bound->span});
  }
  try {
    Diagnostics diagnostics;
    auto record = load(request, diagnostics);
    if (!record) throw UnusableData(std::move(diagnostics));
    return std::move(*record);
  } catch (IoError const& error) {
    Diagnostics diagnostics;
    diagnostics.add(unreadable(block, request.path, error.what()));
    throw UnreadableData(std::move(diagnostics));
  }
}

Experiment cut(Record const& record, DataBlock const& block, int part, StartRule start) {
  std::string const name = data_name(block, part);
  DataPart whole;
  whole.span = block.span;
  DataPart const& rows = part < 0 ? whole : block.parts[static_cast<std::size_t>(part)];
  RowRange range{rows.first, rows.last == 0 ? record.rows() : rows.last};
  std::string const what = part < 0 ? "data `" + block.name + "`" : "part `" + rows.name + "`";
  if (auto const wrong = check_rows(record, what, range, rows.span)) throw UserError(*wrong);
  int from = 1;
  if (start.kind != StartRule::Kind::record) from = range.first;
  if (start.kind == StartRule::Kind::estimated) {
    if (range.first + start.rows > range.last)
      throw UserError(
          {Severity::error,
           "E4201",
           fmt::format("{} has {} rows, its start needs {} and more to score", what, range.last - range.first + 1, start.rows),
           Label{rows.span, {}},
           {},
           "take more rows, or estimate the start from fewer"});
    range.first += start.rows;
  }
  return make_experiment(record, name, from, range, rows.span);
}

std::vector<ExperimentData> load_experiments(Session& session, std::vector<ExperimentUse> const& uses, int model, StartRule start) {
  std::vector<ExperimentData> all;
  for (ExperimentUse const& use : uses) {
    Record const& record = session.record(use.data, model);
    all.push_back({use, record, cut(record, session.file.data[static_cast<std::size_t>(use.data)], use.part, start)});
  }
  return all;
}

std::vector<Experiment> experiments_of(std::vector<ExperimentData> const& data) {
  std::vector<Experiment> all;
  for (ExperimentData const& each : data) all.push_back(each.experiment);
  return all;
}

std::shared_ptr<ParameterSpace const> parameter_space(Model const& model, std::vector<ExperimentUse> const& uses) {
  std::vector<ExperimentMember> members;
  for (ExperimentUse const& use : uses) members.push_back({use.name, use.constants});
  return std::make_shared<ParameterSpace const>(model, std::move(members));
}

std::string data_names(CheckedFile const& file, std::vector<ExperimentUse> const& uses) {
  std::string text;
  for (ExperimentUse const& use : uses)
    text += (text.empty() ? "" : ", ") + data_name(file.data[static_cast<std::size_t>(use.data)], use.part);
  return text;
}

std::vector<PriorInfo> priors_of(ParameterSpace const& space, std::vector<PriorInfo> const& of_model) {
  std::vector<PriorInfo> all;
  for (int const r : space.sampled()) {
    FittedParameter const& row = space.rows()[static_cast<std::size_t>(r)];
    std::string const& name = space.model().parameters[static_cast<std::size_t>(row.parameter)].name;
    auto const prior = std::find_if(of_model.begin(), of_model.end(), [&](PriorInfo const& each) { return each.name == name; });
    if (prior == of_model.end()) continue;
    all.push_back(*prior);
    all.back().name = row.name;
  }
  return all;
}

DataInfo describe_data(CheckedFile const& file, ExperimentData const& data, Model const& model) {
  DataBlock const& block = file.data[static_cast<std::size_t>(data.use.data)];
  DataInfo info;
  info.name = data.experiment.name;
  info.file = block.path;
  info.sha256 = data.record.digest;
  info.rows = data.record.rows();
  info.scored = static_cast<int>(std::count(data.experiment.scored.begin(), data.experiment.scored.end(), 1));
  for (Quantity const& input : model.inputs)
    for (DataInputUse const& use : block.inputs)
      if (use.input == input.name)
        info.notes.push_back(fmt::format("input {} = {}{}, {}", input.name, use.column,
                                         use.unit ? fmt::format(" [{}]", use.unit->text) : std::string(), rule_name(use.rule)));
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
  return info;
}

}  // namespace sysid
