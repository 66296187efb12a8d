// Columns are matched to the model's inputs and channels by name, in the model's order.
#include "experiment/experiments.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/system/digest.hpp"
#include "core/system/files.hpp"
#include "core/text/number.hpp"
#include "data/record_rows.hpp"
#include "experiment/record_request.hpp"
#include "experiment/true_parameters.hpp"
#include "model/lags.hpp"
#include "solver/linear_structure.hpp"

namespace sysid {
namespace {

// `lab/bench.csv` in lab/mount.sysid, which is there for who stands beside the folder: its path from the file.
std::string from_folder_of_file(DataBlock const& block, std::filesystem::path const& path) {
  std::string const whole = path.string();
  std::error_code failed;
  if (!whole.ends_with(block.path) || whole.size() == block.path.size() || !std::filesystem::is_regular_file(block.path, failed))
    return {};
  std::filesystem::path const folder = whole.substr(0, whole.size() - block.path.size());
  std::filesystem::path const relative = std::filesystem::relative(block.path, folder, failed);
  return failed ? std::string() : relative.string();
}

// Says which files of the folder have names like the one wanted.
Diagnostic unreadable(DataBlock const& block, std::filesystem::path const& path, std::string message) {
  std::vector<std::string> near;
  for (std::filesystem::path const file : files_beside(path))
    near.push_back((std::filesystem::path(block.path).parent_path() / file.filename()).string());
  std::string const guess = did_you_mean(block.path, near);
  std::string help = "paths are relative to the folder of the .sysid file";
  if (block.path.find_first_of("*?") != std::string::npos)
    help = "a data block reads one file: write its name, and a block for each file";
  else if (block.path.starts_with("~"))
    help = "`~` is not replaced by your home folder: write the path from `/`, or relative to the folder of the .sysid file";
  else if (block.path.find("://") != std::string::npos)
    help = "only files of this machine are read: download it, and write its path";
  if (std::string const beside = from_folder_of_file(block, path); !beside.empty())
    return {Severity::error, "E4018", std::move(message), Label{block.path_span, {}}, {}, help + ": write `" + beside + "`"};
  return {Severity::error, "E4018", std::move(message), Label{block.path_span, {}}, {}, guess.empty() ? help : guess};
}

// The block has no times that could be wrong in one row: it and the model contradict each other.
Diagnostic step_of_block(DataBlock const& block, double step, Model const& model) {
  std::string const as_rate = block.step_stated ? "" : fmt::format(" (a rate of {:.9g} Hz)", 1 / step);
  return {Severity::error,
          "E4203",
          fmt::format("data `{}` has a step of {:.9g} s{}, but model `{}` has steps of {:.9g} s", block.name, step, as_rate,
                      model.name, *model.step),
          Label{*block.step_place, {}},
          {},
          block.step_stated
              ? fmt::format("one of the two is wrong: write `step {0:.9g} [s]` here, or `time discrete {1:.9g} [s]` in the model",
                            *model.step, step)
              : fmt::format("one of the two is wrong: write `rate {0:.9g} [Hz]` here, or `time discrete {1:.9g} [s]` in the model",
                            1 / *model.step, step),
          {block.name, model.name}};
}

// A model in discrete time goes from row to row: these must be as far apart as it says, and equally far.
void check_steps(Record const& record, DataBlock const& block, Model const& model) {
  double const mean = (record.time.back() - record.time.front()) / static_cast<double>(record.rows() - 1);
  double const wanted = model.step.value_or(mean);
  std::string const help =
      record.rounded && (!model.step || same_step(1 / record.rounded->rate, *model.step))
          ? fmt::format("equal steps give these times when they are rounded: write `rate {} [Hz]` in place of `time` in `{}`",
                        shortest(record.rounded->rate), block.name)
          : "correct `time discrete`, or resample the record to equal steps; differences of up to 1 % of the step, such as "
            "those of rounded times, are accepted";
  for (std::size_t i = 1; i < record.time.size(); ++i) {
    double const step = record.time[i] - record.time[i - 1];
    if (same_step(step, wanted)) continue;
    if (block.step_place) throw UserError(step_of_block(block, step, model));
    throw UserError(
        {Severity::error,
         "E4203",
         model.step
             ? fmt::format("row {} of `{}` is {:.9g} s after the row before, but model `{}` has steps of {:.9g} s", i + 1,
                           block.mention(), step, model.name, wanted)
             : fmt::format(
                   "row {} of `{}` is {:.9g} s after the row before, but the mean step is {:.9g} s: model `{}` needs equal steps",
                   i + 1, block.mention(), step, wanted, model.name),
         Label{block.time ? block.time->span : block.span, {}},
         {},
         help,
         {model.name}});
  }
}

// Samples that the density of a channel reads and that are missing: the row cannot be scored. One that the map from row to row
// reads would spoil all that follows: an error.
void mark_past(Experiment& experiment, Model const& model, Span place) {
  int const rows = static_cast<int>(experiment.time.size());
  auto const missing = [&](PastSample const& sample, int row) {
    return std::isnan(measured_sample(experiment, sample.channel, row - sample.lag));
  };
  auto const refuse = [&](PastSample const& sample, int row) {
    throw UserError(
        {Severity::error,
         "E4204",
         fmt::format("`{}` is missing in row {}, but model `{}` needs it for later rows",
                     model.channels[static_cast<std::size_t>(sample.channel)].name, experiment.first_row + row - sample.lag,
                     model.name),
         Label{place, {}},
         {},
         "fill the gap, choose other rows, or write `with prediction = free_run`: the model then uses its own prediction",
         {model.channels[static_cast<std::size_t>(sample.channel)].name, model.name}});
  };
  for (PastSample const& sample : lagged_samples(model, -2))
    if (missing(sample, 0)) refuse(sample, 0);
  for (PastSample const& sample : lagged_samples(model, -1))
    for (int row = 0; row + 1 < rows; ++row)
      if (missing(sample, row)) refuse(sample, row);
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    std::vector<PastSample> const samples = lagged_samples(model, static_cast<int>(c));
    if (samples.empty()) continue;
    if (experiment.has_lags.empty()) experiment.has_lags.resize(model.channels.size());
    experiment.has_lags[c].assign(static_cast<std::size_t>(rows), 1);
    for (int row = 0; row < rows; ++row)
      for (PastSample const& sample : samples)
        if (missing(sample, row)) experiment.has_lags[c][static_cast<std::size_t>(row)] = 0;
  }
}

/// A log-normal noise has only positive values: no parameter explains another sample. Counts are seen to where they are read.
void refuse_values_outside(Experiment const& experiment, DataBlock const& block, Model const& model) {
  for (std::size_t c = 0; c < model.channels.size(); ++c) {
    Channel const& channel = model.channels[c];
    if (channel.noise.row->lower == nullptr || channel.noise.row->discrete) continue;
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) {
      double const value = experiment.measured[c][i];
      if (!experiment.is_scored(c, i) || !(value <= 0)) continue;
      auto const bound = std::find_if(block.measured.begin(), block.measured.end(),
                                      [&](DataMeasureUse const& each) { return each.channel == channel.name; });
      throw UserError(
          {Severity::error,
           "E4206",
           fmt::format("row {} of `{}`: `{}` is {:.6g}, but `{}` has only positive values",
                       experiment.first_row + static_cast<int>(i), block.mention(), channel.name, channel.from_si(value),
                       channel.noise.row->name),
           Label{bound == block.measured.end() ? block.span : bound->span, {}},
           {},
           fmt::format("if the sensor gave no value, empty the cell: the sample is then left out; if such a value can be "
                       "true, write another noise, such as `observe {} ~ normal(..., sd = ...)`",
                       channel.name),
           {channel.name, std::string(channel.noise.row->name)}});
    }
  }
}

}  // namespace

bool predicts_from_data(Model const& model) {
  for (int c = -1; c < static_cast<int>(model.channels.size()); ++c)
    if (!lagged_samples(model, c).empty()) return true;
  return false;
}

std::string prediction_text(Model const& model, PredictionRule rule) {
  bool const from_data = predicts_from_data(model);
  bool const from_model = !model.states.empty();
  return fmt::format("{}: from {}", prediction_name(rule),
                     from_data && from_model ? "measured samples and the model's own past samples"
                     : from_data             ? "measured samples, one step ahead"
                                             : "the model's own past samples, a free run");
}

std::string predicted_text(Model const& model, PredictionRule rule, int ahead) {
  std::string const lags = model.dynamics == Dynamics::discrete ? prediction_text(model, rule) : std::string();
  if (!model.filtered()) return lags;
  bool const one_step = rule == PredictionRule::one_step;
  std::string const corrected = one_step ? "states estimated from all samples before each row"
                                         : "states estimated only from the samples before the first predicted row";
  if (ahead > 1) return fmt::format("steps({}): states estimated from the samples at least {} rows before each row", ahead, ahead);
  if (!lags.empty()) return fmt::format("{}; {}", lags, corrected);
  return fmt::format("{}: {}", prediction_name(one_step ? rule : PredictionRule::free_run), corrected);
}

std::string data_name(DataBlock const& block, int part) {
  return part < 0 ? block.name : block.name + "." + block.parts[static_cast<std::size_t>(part)].name;
}

bool reads_time(Model const& model) {
  Graph const& graph = model.graph;
  for (NodeId id = 0; id < graph.size(); ++id)
    if (graph[id].operation == Operation::leaf && graph[id].leaf_kind == LeafKind::time) return true;
  return false;
}

RecordRequest record_request(DataBlock const& block, Model const& model, std::filesystem::path const& folder) {
  RecordRequest request;
  request.path = (folder / block.path).string();
  request.shown_path = block.shown_path;
  request.mention = block.path_span;
  request.rules = block.rules;
  request.step = block.step > 0 ? block.step : model.step.value_or(0);
  request.independent_rows = model.dynamics == Dynamics::none;
  request.uses_times = reads_time(model);
  if (block.time) request.time = ColumnRequest{block.time->column, block.time->unit, std::nullopt, block.time->span};
  for (Quantity const& input : model.inputs) {
    auto const bound =
        std::find_if(block.inputs.begin(), block.inputs.end(), [&](auto const& each) { return each.input == input.name; });
    InputRequest column;
    static_cast<ColumnRequest&>(column) = {bound->column, bound->unit, input.unit, bound->span};
    column.rule = bound->rule.value_or(InputRule::zero_order);
    request.inputs.push_back(std::move(column));
  }
  for (Channel const& channel : model.channels) {
    auto const bound =
        std::find_if(block.measured.begin(), block.measured.end(), [&](auto const& each) { return each.channel == channel.name; });
    if (bound == block.measured.end())
      request.measured.emplace_back();
    else
      request.measured.push_back(ColumnRequest{bound->column, bound->unit, channel.unit, bound->span, channel.noise.row->discrete});
  }
  return request;
}

void require_steps(Record const& record, DataBlock const& block, Model const& model) {
  if (model.dynamics == Dynamics::discrete) check_steps(record, block, model);
}

Record load_record(DataBlock const& block, Model const& model, std::filesystem::path const& folder) {
  RecordRequest const request = record_request(block, model, folder);
  try {
    Diagnostics diagnostics;
    auto record = load(request, diagnostics);
    if (!record) throw UnusableData(std::move(diagnostics));
    require_steps(*record, block, model);
    return std::move(*record);
  } catch (IoError const& error) {
    Diagnostics diagnostics;
    diagnostics.add(unreadable(block, request.path, error.what()));
    throw UnreadableData(std::move(diagnostics));
  }
}

Experiment cut(Record const& record, DataBlock const& block, Model const& model, int part, StartRule start) {
  std::string const name = data_name(block, part);
  DataPart whole;
  whole.span = block.span;
  DataPart const& rows = part < 0 ? whole : block.parts[static_cast<std::size_t>(part)];
  RowRange range{rows.first, rows.last == 0 ? record.rows() : rows.last};
  std::string const what = part < 0 ? "data `" + block.name + "`" : "range `" + rows.name + "`";
  if (auto const wrong = check_rows(record, what, range, rows.span)) throw UserError(*wrong);
  // The first rows that a model only looks back to are neither simulated nor scored.
  int const history = data_lag(model);
  if (range.last <= history)
    throw UserError({Severity::error,
                     "E4201",
                     fmt::format("{} ends at row {}, but model `{}` needs {} earlier rows", what, range.last, model.name, history),
                     Label{rows.span, {}},
                     {},
                     "use more rows, or fewer lags",
                     {part < 0 ? block.name : rows.name, model.name}});
  range.first = std::max(range.first, history + 1);
  int from = history + 1;
  if (start.kind != StartRule::Kind::record) from = range.first;
  if (start.kind == StartRule::Kind::estimated) {
    if (range.first + start.rows > range.last)
      throw UserError(
          {Severity::error,
           "E4201",
           fmt::format("{} has {} rows, but estimating the initial state uses {} rows, and the fit needs further rows to score",
                       what, range.last - range.first + 1, start.rows),
           Label{rows.span, {}},
           {},
           "use more rows, or estimate the start from fewer rows",
           {part < 0 ? block.name : rows.name}});
    range.first += start.rows;
  }
  Experiment experiment = make_experiment(record, name, from, range, rows.span, history);
  mark_past(experiment, model, rows.span);
  refuse_values_outside(experiment, block, model);
  return experiment;
}

namespace {

std::vector<NodeId> derivatives_of(Model const& model) {
  std::vector<NodeId> derivatives;
  for (State const& state : model.states) derivatives.push_back(state.derivative);
  return derivatives;
}

/// An input that is neither held nor, where the equations read all inputs linearly, a straight line between its samples.
struct CurvedInput {
  std::size_t index;
  bool to_be_held;
};
std::optional<CurvedInput> curved_input(Experiment const& experiment, Model const& model) {
  std::vector<int> const held = inputs_not_linear(model.graph, derivatives_of(model));
  for (std::size_t i = 0; i < experiment.inputs.size(); ++i) {
    bool const hold = std::find(held.begin(), held.end(), static_cast<int>(i)) != held.end();
    if (experiment.inputs[i].degree() > (hold ? 0 : 1)) return CurvedInput{i, hold};
  }
  return std::nullopt;
}

}  // namespace

bool is_linear_in_states(Model const& model) {
  return model.integrated() && !model.implicit && std::ssize(model.states) <= most_exact_states &&
         !find_nonlinear(model.graph, derivatives_of(model));
}

bool allows_exact_steps(Experiment const& experiment, Model const& model) {
  return is_linear_in_states(model) && !curved_input(experiment, model);
}

void require_exact_steps(Experiment const& experiment, DataBlock const& block, Model const& model, SolverSettings const& solver) {
  if (!model.integrated() || !solver.row().exact) return;
  std::optional<CurvedInput> const curved = curved_input(experiment, model);
  if (!curved) return;
  std::string const& name = model.inputs[curved->index].name;
  auto const bound = std::find_if(block.inputs.begin(), block.inputs.end(), [&](auto const& each) { return each.input == name; });
  throw UserError(
      {Severity::error,
       "E4205",
       curved->to_be_held
           ? fmt::format("`{}` is exact only if `{}`, which enters the equations nonlinearly, is constant between its samples",
                         solver.method, name)
           : fmt::format("`{}` is exact only if `{}` is constant or a straight line between its samples", solver.method, name),
       Label{bound == block.inputs.end() ? block.span : bound->rule_span, {}},
       {},
       fmt::format("use another solver, or `hold {}` if that is what the input did",
                   curved->to_be_held ? "zero_order" : "zero_order` or `hold linear"),
       {solver.method, name}});
}

bool allow_exact_steps(std::vector<ExperimentData> const& data, Model const& model) {
  return std::ranges::all_of(data, [&](ExperimentData const& each) { return allows_exact_steps(each.experiment, model); });
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

}  // namespace sysid
