// The draws of a fit as a normal distribution on unbounded scales, and the states that its record passes through.
#include "app/tracking/tracked_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/session/stored_draws.hpp"
#include "check/checked/task_kinds.hpp"
#include "core/numeric/not_finite.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/files.hpp"
#include "core/text/words.hpp"
#include "data/format/open_record.hpp"
#include "data/table/encoding.hpp"
#include "data/table/gzip.hpp"
#include "data/table/table.hpp"
#include "data/table_record.hpp"
#include "experiment/record_request.hpp"
#include "model/lags.hpp"
#include "report/file/stored_files.hpp"
#include "tracking/tracking_steps.hpp"

namespace sysid {
namespace {

void require_trackable(Model const& model) {
  std::string const name = fmt::format("model `{}`", model.name);
  if (!model.processes.empty())
    throw no_tracking(name + " has unknown functions: it cannot be tracked", "fit with the function replaced by a formula");
  if (!model.unknowns.empty() || model.implicit)
    throw no_tracking(name + " has equations that are not of the form y' = f: it cannot be tracked",
                      "solve the equations for the highest derivatives by hand");
  if (!model.memories.empty())
    throw no_tracking(name + " uses `since_last`, which needs values at the previous row: it cannot be tracked",
                      "observe the quantity itself, with a column of its values in the record");
  for (Channel const& channel : model.channels)
    if (!channel.noise.row->gaussian || channel.noise.lower || channel.noise.upper)
      throw no_tracking(fmt::format("the noise of `{}` is not normal: a Kalman filter cannot track {}", channel.name, name),
                        "fit with normal noise and track from that fit");
}

/// The experiment of the fit that has the wanted data block, else none.
ExperimentUse use_of(Session const& session, FitTask const& fit, std::string const& data) {
  if (data.empty()) return fit.experiments.front();
  for (ExperimentUse const& use : fit.experiments)
    if (session.file.data[static_cast<std::size_t>(use.data)].name == data) return use;
  std::vector<std::string> names;
  for (ExperimentUse const& use : fit.experiments) {
    std::string const& name = session.file.data[static_cast<std::size_t>(use.data)].name;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  throw no_tracking(
      fmt::format("the fit has no data `{}`", data),
      fmt::format("its data: {}; other records with the same columns are read with --record FILE", fmt::join(names, ", ")));
}

/// Of all draws the parameters of an experiment, SI [parameters x draws].
LaneArray drawn_parameters(Model const& model, FitTask const& fit, FittedModel const& fitted, std::size_t experiment) {
  auto const space = parameter_space(model, fit.experiments);
  LaneArray const declared = spread(fitted.draws, static_cast<int>(fitted.draws.total()));
  LaneArray own(static_cast<int>(model.parameters.size()), declared.width());
  space->select(space->values_of_declared(declared), static_cast<int>(experiment), own);
  return own;
}

/// Draws of the same text of the model. The data may have grown since: that is what tracking is for.
FittedModel stored_fit(Session const& session, Task const& task, FitTask const& fit, std::filesystem::path const& folder) {
  auto const summary = nlohmann::json::parse(read_whole_summary(folder));
  bool const same = interpreted(folder / "summary.json", [&] {
    return summary.value("verb", "") == "fit" && summary.at("versions").value("model_sha256", "") == task_digest(session, task);
  });
  if (!same || std::filesystem::exists(checkpoint_path(folder)))
    throw no_tracking(fmt::format("`{}` contains no finished fit of the model as it is written now", folder.string()),
                      "run the fit again: sysid fit FILE --force");
  auto const space = parameter_space(session.file.models[static_cast<std::size_t>(fit.model)], fit.experiments);
  std::vector<std::string> names;
  for (ParameterInfo const& each : space->infos()) names.push_back(each.name);
  return read_fitted(folder, names);
}

/// The rows of a data block's file that are whole: another program may be writing the last one.
Record record_so_far(DataBlock const& block, Model const& model, std::filesystem::path const& folder) {
  RecordRequest const request = record_request(block, model, folder);
  std::string text = read_file(request.path);
  Diagnostics diagnostics;
  if (format_of(text) != nullptr || is_gzip(text) || has_utf16_mark(text)) {  // no lines that are appended
    auto whole = load(request, diagnostics);
    if (!whole) throw UnusableData(std::move(diagnostics));
    require_steps(*whole, block, model);
    return std::move(*whole);
  }
  if (auto const end = text.rfind('\n'); end != std::string::npos) text.resize(end + 1);
  auto record = read_record(request, Table::parse(request.path, std::move(text), request.mention, 0, request.rules), diagnostics);
  if (!record) throw UnusableData(std::move(diagnostics));
  require_steps(*record, block, model);
  return std::move(*record);
}

bool reads(Graph const& graph, NodeId root, int parameter) {
  return graph.depends(root, [&](Node const& leaf) { return leaf.leaf_kind == LeafKind::parameter && leaf.index == parameter; });
}

/// Whether the states or the centres of channels depend on it: what only noise or a start reads shows in no innovation's mean.
bool in_equations(Model const& model, int parameter) {
  for (State const& state : model.states)
    if (reads(model.graph, state.derivative, parameter)) return true;
  for (Channel const& channel : model.channels)
    if (reads(model.graph, channel.noise.arguments[0], parameter)) return true;
  return false;
}

/// The step of rows that follow each other at one: nine in ten are within a tenth of the median.
std::optional<double> one_step(std::vector<double> const& time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  if (steps.empty()) return std::nullopt;
  double const usual = median(steps);
  auto const alike = std::ranges::count_if(steps, [&](double each) { return std::fabs(each - usual) <= 0.1 * usual; });
  if (10 * static_cast<std::size_t>(alike) < 9 * steps.size()) return std::nullopt;
  return usual;
}

class FitForTracking {
 public:
  FitForTracking(Session& session, TrackOptions const& options) : session_(session) { result_.options = options; }

  TrackedFit make() {
    read_fit();
    require_trackable(result_.model());
    choose();
    scale();
    TrackedFit& all = result_;
    MomentRule const rule = all.options.filter == FilterRule::unscented ? MomentRule::sigma_points : MomentRule::linearised;
    all.program = compile_tracking(all.model(), all.values, all.tracked, all.solver.method, rule);
    look_along();
    limit();
    return std::move(result_);
  }

 private:
  void read_fit() {
    result_.task = &task_of_result(session_, result_.options.result);
    result_.fit = &std::get<FitTask>(result_.task->what);
    FittedModel const fitted = stored_fit(session_, *result_.task, *result_.fit, result_.options.result);
    if (fitted.draws.total() < 10)
      throw no_tracking(fmt::format("`{}` contains an optimum without draws: the uncertainty of its parameters is not known",
                                    result_.options.result.string()),
                        "track from a fit that samples: `with mh` or `with nuts`");
    result_.compiled = session_.compiled(*result_.fit, false, fitted.solver.method, result_.fit->prediction);
    result_.solver = steps_for_tracking(fitted.solver);
    result_.use = use_of(session_, *result_.fit, result_.options.data);
    std::size_t experiment = 0;
    while (result_.fit->experiments[experiment].name != result_.use.name) ++experiment;
    drawn_ = drawn_parameters(result_.model(), *result_.fit, fitted, experiment);
    for (int r = 0; r < drawn_.rows(); ++r) {
      double sum = 0;
      for (double const value : drawn_.row(r)) sum += value;
      Parameter const& parameter = result_.model().parameters[static_cast<std::size_t>(r)];
      bool const fixed = parameter.value && !parameter.per_experiment;
      result_.values.push_back(fixed ? *result_.model().graph.constant_value(*parameter.value) : sum / drawn_.width());
    }
  }

  bool is_sampled(int p) const {
    auto const draws = drawn_.row(p);
    return std::any_of(draws.begin(), draws.end(), [&](double value) { return value != draws.front(); });
  }

  void choose() {
    Model const& model = result_.model();
    std::vector<std::string> wanted = result_.options.parameters, possible;
    for (int const p : model.sampling_order)
      if (in_equations(model, p) && is_sampled(p)) possible.push_back(model.parameters[static_cast<std::size_t>(p)].name);
    for (std::string const& name : wanted)
      if (std::find(possible.begin(), possible.end(), name) == possible.end())
        throw no_tracking(fmt::format("`{}` cannot be tracked", name),
                          fmt::format("those in the equations: {}", fmt::join(possible, ", ")));
    for (std::size_t p = 0; p < model.parameters.size(); ++p) {
      Parameter const& parameter = model.parameters[p];
      auto const is_in = [&](std::vector<std::string> const& names) {
        return std::find(names.begin(), names.end(), parameter.name) != names.end();
      };
      if (!is_in(wanted.empty() ? possible : wanted)) {
        if (is_sampled(static_cast<int>(p))) result_.fixed.push_back(parameter.name);
        continue;
      }
      result_.tracked.push_back(bounded(static_cast<int>(p)));
    }
    if (result_.tracked.empty()) throw no_tracking("no parameter of the fit occurs in an equation", "track from another fit");
  }

  /// Bounds that depend on other parameters are those at the posterior mean, unless a draw lies outside.
  TrackedParameter bounded(int p) {
    Graph graph = result_.model().graph;
    Support const allowed = support(graph, *result_.model().parameters[static_cast<std::size_t>(p)].prior);
    auto const number = [&](std::optional<NodeId> const& bound) -> std::optional<double> {
      if (!bound) return std::nullopt;
      return graph.evaluate(*bound, [&](NodeId leaf) { return result_.values[static_cast<std::size_t>(graph[leaf].index)]; });
    };
    TrackedParameter tracked{p, number(allowed.lower), number(allowed.upper), allowed.logarithmic};
    for (double const value : drawn_.row(p))
      if ((tracked.lower && value <= *tracked.lower) || (tracked.upper && value >= *tracked.upper)) return {p, {}, {}, false};
    return tracked;
  }

  /// Mean and covariance of the draws on the unbounded scales; how far a drift goes there.
  void scale() {
    auto const count = static_cast<Eigen::Index>(result_.tracked.size());
    Eigen::MatrixXd all(count, drawn_.width());
    for (Eigen::Index j = 0; j < count; ++j) {
      TrackedParameter const& tracked = result_.tracked[static_cast<std::size_t>(j)];
      Graph graph;
      Support bounds;
      if (tracked.lower) bounds.lower = graph.constant(*tracked.lower);
      if (tracked.upper) bounds.upper = graph.constant(*tracked.upper);
      bounds.logarithmic = tracked.logarithmic;
      NodeId const value = graph.leaf(LeafKind::parameter);
      Kernel const kernel = compile_kernel(graph, {&value, 1}, std::vector{unconstrain(graph, bounds, value)});
      for (int w = 0; w < drawn_.width(); ++w) run_scalar(kernel, std::vector{drawn_(tracked.parameter, w)}, {&all(j, w), 1});
    }
    result_.prior.mean = all.rowwise().mean();
    all.colwise() -= result_.prior.mean;
    result_.prior.covariance = all * all.transpose() / (drawn_.width() - 1);
  }

  void look_along() {
    FitTask const& fit = *result_.fit;
    Model const& of_file = session_.file.models[static_cast<std::size_t>(fit.model)];
    StartRule const start = fit.start.kind == StartRule::Kind::estimated ? StartRule{StartRule::Kind::rest, 0} : fit.start;
    DataBlock const& block = result_.block(session_);
    Experiment const experiment =
        cut(record_so_far(block, of_file, session_.folder()), block, result_.model(), result_.use.part, start);
    result_.fitted_from = experiment.first_row;
    StatePrior const first = result_.at_rest(experiment);
    ExecutionOptions const execution = session_.abandonable();
    result_.solver = tracking_solver(result_.program, result_.solver, execution, experiment, first, result_.prior);
    result_.states =
        states_along(result_.program, result_.solver, execution, experiment, first, result_.prior, result_.model().filtered());
    result_.step = experiment.time.size() > 1 ? mean_step(experiment.time) : 1;
    result_.tracking.anywhere = result_.states;
    // What drives the equations in a gap is not known; without inputs the filter goes through it.
    if (result_.model().integrated() && !result_.model().inputs.empty())
      result_.tracking.usual_step = one_step(experiment.time).value_or(0);
  }

  /// How far parameters drift, and what a large change of one is, on their unbounded scales.
  void limit() {
    TrackOptions const& options = result_.options;
    auto const count = static_cast<std::size_t>(result_.program.tracked);
    std::vector<double> values(2 * count);
    run_scalar(result_.program.values, {result_.prior.mean.data(), count}, values);
    result_.tracking.false_alarms = options.false_alarms;
    result_.tracking.window = options.window;
    result_.tracking.leaves_out = data_lag(result_.model()) == 0;
    bool const by_rows = !result_.model().integrated();  // intensities are per row, else per second
    double const rows = options.drift.time > 0 ? options.drift.time / result_.step : 1000;
    for (std::size_t j = 0; j < count; ++j) {
      auto const at = static_cast<Eigen::Index>(j);
      double const slope = std::fabs(values[count + j]), sd = slope * std::sqrt(result_.prior.covariance(at, at));
      double const whole = std::max(std::fabs(values[j]), sd) / slope, per_row = std::pow(options.drift.relative * whole, 2) / rows;
      result_.tracking.scales.push_back(whole);
      result_.tracking.intensities.push_back(by_rows ? per_row : per_row / result_.step);
    }
  }

  Session& session_;
  TrackedFit result_;
  LaneArray drawn_;
};

/// The folder of a whole run has one folder for each task.
void refuse_folder_of_run(std::filesystem::path const& folder) {
  if (std::filesystem::exists(folder / "summary.json")) return;
  std::vector<std::string> tasks;
  for (auto const& each : std::filesystem::directory_iterator(folder))
    if (std::filesystem::exists(each.path() / "summary.json")) tasks.push_back(each.path().string());
  std::sort(tasks.begin(), tasks.end());
  if (!tasks.empty())
    throw no_tracking(fmt::format("`{}` holds the results of a whole run", folder.string()),
                      fmt::format("give the folder of one of its fits: {}", quoted(tasks)));
}

}  // namespace

Task const& task_of_result(Session const& session, std::filesystem::path const& folder) {
  if (!std::filesystem::is_directory(folder)) throw no_results_folder(folder);
  refuse_folder_of_run(folder);
  auto const summary = nlohmann::json::parse(read_summary(folder));
  std::string const name = interpreted(folder / "summary.json", [&] { return summary.at("task").get<std::string>(); });
  std::vector<std::string> fits;
  for (Task const& task : session.file.tasks) {
    if (kind_of(task) != TaskKind::fit) continue;
    if (task.name == name) return task;
    fits.push_back(task.name);
  }
  throw no_tracking(
      fmt::format("`{}` holds results of `{}`, which is no fit task of {}", folder.string(), name, session.source.name()),
      fits.empty() ? "give the folder of a fit" : fmt::format("give the folder of one of the fits: {}", fmt::join(fits, ", ")));
}

StatePrior TrackedFit::at_rest(Experiment const& experiment) const {
  Model const& of = model();
  auto const n = static_cast<Eigen::Index>(of.states.size());
  StatePrior prior{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n), false};
  auto const value = [&](NodeId root) {
    return of.graph.evaluate(root, [&](NodeId leaf) {
      Node const& node = of.graph[leaf];
      if (node.leaf_kind == LeafKind::parameter) return values[static_cast<std::size_t>(node.index)];
      double const sample = node.leaf_kind == LeafKind::measured ? measured_sample(experiment, node.index, -node.lag) : 0;
      return std::isfinite(sample) ? sample : 0;
    });
  };
  for (Eigen::Index i = 0; i < n; ++i) {
    State const& state = of.states[static_cast<std::size_t>(i)];
    prior.mean(i) = value(state.initial);
    if (state.initial_variance) prior.covariance(i, i) = value(*state.initial_variance);
  }
  return prior;
}

UserError no_tracking(std::string message, std::string help) {
  return UserError({Severity::error, "", std::move(message), std::nullopt, {}, std::move(help)});
}

TrackedFit tracked_fit(Session& session, TrackOptions const& options) { return FitForTracking(session, options).make(); }

}  // namespace sysid
