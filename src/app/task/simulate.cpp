// `simulate`: data made from stated values, as a CSV that a data block reads.
#include "app/task/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <set>

#include "app/session/session.hpp"
#include "app/task/drawn_functions.hpp"
#include "app/task/signals.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/files.hpp"
#include "core/text/number.hpp"
#include "diagnostics/drift.hpp"
#include "diagnostics/function_ranges.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/trajectory.hpp"
#include "report/file/csv.hpp"

namespace sysid {
namespace {

// Made data carry the error of the integrator: said when it is more than a tenth of the noise (or a thousandth of the response).
void check_step(Session& session, Task const& task, SimulateTask const& what, std::shared_ptr<CompiledModel const> const& compiled,
                Experiment const& experiment, LaneArray const& parameters, Trajectory::Result const& result) {
  Trajectory const finer(compiled, experiment, what.solver.finer(), 0, session.options.execution);
  Trajectory::Result const fine = finer.run(parameters, {});
  if (fine.failed() > 0) {
    session.notices << fmt::format("{}: warning: with {} the simulation fails, so the error of this one is not known\n", task.name,
                                   what.solver.finer_words());
    return;
  }
  double const tolerable = what.noise_fraction > 0 ? 0.1 * what.noise_fraction : 1e-3;
  for (std::size_t q = 0; q < finer.quantities().size(); ++q) {
    if (finer.quantities()[q].channel < 0) continue;
    std::vector<double> difference = result.values[q][0];
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= fine.values[q][0][i];
    double const share = std::sqrt(population_variance(difference)) / std::sqrt(population_variance(fine.values[q][0]));
    if (share > tolerable)
      session.notices << fmt::format("{}: warning: with {} {} changes by {:.2g} % of its size; add `{}` or finer\n", task.name,
                                     what.solver.finer_words(), finer.quantities()[q].name, 100 * share,
                                     what.solver.finer().option());
  }
}

std::string unit_suffix(std::string const& unit) { return unit.empty() ? std::string() : " [" + unit + "]"; }

// "does not stay finite: `y^3` (duffing.sysid:10:27) at t = 0.1 s"; the place is left out when the failure cannot be repeated.
std::string first_failure(Session const& session, SimulateTask const& what, CompiledModel const& compiled, Experiment experiment,
                          LaneArray const& parameters) {
  // A solve is looked into up to the last sample to score: the states on the way, not what they would be compared with.
  for (auto& channel : experiment.measured) {
    channel.assign(experiment.time.size(), std::nan(""));
    channel.back() = 0;
  }
  Simulator const simulator(compiled.likelihood, Schedule(*compiled.likelihood, experiment, what.solver),
                            session.options.execution);
  std::vector<double> values;
  // What only the noise reads may have no value; any does here.
  for (int p = 0; p < parameters.rows(); ++p) values.push_back(std::isnan(parameters(p, 0)) ? 1.0 : parameters(p, 0));
  auto const found = simulator.diagnose(values);
  if (!found) return "does not stay finite";
  std::string const failed =
      found->kind == FailureClass::non_finite ? "does not stay finite" : fmt::format("fails ({})", name(found->kind));
  return fmt::format("{}: {} at t = {:.4g} s", failed, session.describe(what.model, simulator.program().source.graph, found->node),
                     found->time);
}

bool reads_samples(Model const& model) {
  for (int c = -1; c < static_cast<int>(model.channels.size()); ++c)
    if (!past_samples(model, c).empty()) return true;
  return false;
}

// Takes from a run what the next one reads; false where that is what this one read.
using Feedback = std::function<bool(Trajectory::Result const& run, Experiment& experiment)>;

// A model that goes on from what it measured: noise enters all that follows.
Feedback measured_samples(CompiledModel const& compiled) {
  return [&compiled](Trajectory::Result const& run, Experiment& experiment) {
    std::vector<std::vector<double>> const before = experiment.measured;
    for (std::size_t c = 0; c < before.size(); ++c)
      for (std::size_t i = 0; i < before[c].size(); ++i) {
        double const made = compiled.model.channels[c].to_si(run.noisy[c][0][i]);
        if (std::isfinite(made)) experiment.measured[c][i] = made;
      }
    return experiment.measured != before;
  };
}

// Processes are the last inputs; before the record they are zero, as all inputs are. Their values may differ by rounding from round
// to round, since jitter is a share of the mean variance.
Feedback drawn_values(DrawnFunctions const& functions, std::vector<double> const& time, int history) {
  return [&functions, &time, history, before = std::vector<std::vector<double>>()](Trajectory::Result const& run,
                                                                                   Experiment& experiment) mutable {
    std::vector<std::vector<double>> now = functions.along(run);
    std::size_t const first = experiment.inputs.size() - now.size();
    double change = 0, size = 0;
    for (std::size_t p = 0; p < now.size(); ++p)
      for (std::size_t i = 0; i < now[p].size(); ++i) {
        change = std::max(change, std::fabs(now[p][i] - (before.empty() ? 0 : before[p][i])));
        size = std::max(size, std::fabs(now[p][i]));
      }
    for (std::size_t p = 0; p < now.size(); ++p) {
      std::vector<double> samples(static_cast<std::size_t>(history), 0.0);
      samples.insert(samples.end(), now[p].begin(), now[p].end());
      experiment.inputs[first + p] =
          InputSignal(InputRule::zero_order, time, std::move(samples)).view(history, static_cast<int>(now[p].size()));
    }
    before = std::move(now);
    return change > 1e-9 * size;
  };
}

// As many rounds as there are feedbacks make at least one more sample right, the draws being the same, so that this would end, were
// it not for rounding, which a chaotic model blows up; a stable model takes few. Nothing: interrupted.
std::optional<Trajectory::Result> in_rounds(Session& session, Task const& task,
                                            std::shared_ptr<CompiledModel const> const& compiled, Experiment& experiment,
                                            SimulateTask const& what, LaneArray const& parameters, StreamKey noise_key,
                                            std::vector<Feedback>& feedbacks) {
  auto const most = static_cast<std::size_t>(what.samples) * feedbacks.size() + 1;
  for (std::size_t round = 0; round <= most; ++round) {
    if (round > 0 && session.interrupted()) return std::nullopt;
    Trajectory const trajectory(compiled, experiment, what.solver, 0, session.options.execution);
    Trajectory::Result result = trajectory.run(parameters, noise_key);
    if (result.failed() > 0) return result;
    bool changed = false;
    for (Feedback& feedback : feedbacks) changed = feedback(result, experiment) || changed;
    if (!changed) return result;
  }
  throw UserError({Severity::error,
                   "E5001",
                   fmt::format("the simulation `{}` does not settle: what it feeds back changes in every round", task.name),
                   Label{task.span, {}},
                   {},
                   "the model may be chaotic, so that rounding grows into values: take fewer samples, or other values"});
}

// With another output folder a data block that reads `results/NAME/FILE` still reads what an earlier run left there.
void warn_of_older_data(Session& session, Task const& task, std::filesystem::path const& written) {
  auto const absolute = [](std::filesystem::path const& path) { return std::filesystem::absolute(path).lexically_normal(); };
  for (DataBlock const& block : session.file.data) {
    std::filesystem::path const read = session.folder() / block.path;
    bool const same_name = read.filename() == written.filename() && read.parent_path().filename() == task.name;
    if (same_name && absolute(read) != absolute(written))
      session.notices << fmt::format("{}: warning: data `{}` reads {}, not what was written now\n", task.name, block.name,
                                     read.string());
  }
}

}  // namespace

ExitCode run_simulate(Session& session, Task const& task, SimulateTask const& what) {
  bool const feeds_back = what.noise_fraction < 0 && reads_samples(session.file.models[static_cast<std::size_t>(what.model)]);
  Model const& written = session.file.models[static_cast<std::size_t>(what.model)];
  // Noise in percent is added to a response without noise.
  PredictionRule const rule =
      written.dynamics == Dynamics::discrete && !feeds_back ? PredictionRule::free_run : PredictionRule::as_written;
  std::uint64_t const seed = session.seed(task, what.seed);
  // Several records made in one run with one seed are different records.
  std::uint64_t ordinal = 0;
  for (Task const& each : session.file.tasks) {
    if (&each == &task) break;
    if (std::holds_alternative<SimulateTask>(each.what)) ++ordinal;
  }
  std::uint64_t const series = ordinal << 32;
  LaneArray parameters(static_cast<int>(written.parameters.size()), 1);
  for (std::size_t p = 0; p < written.parameters.size(); ++p)
    parameters(static_cast<int>(p), 0) = what.values[p].value_or(std::nan(""));
  StreamKey const function_key{seed, Purpose::prior, series, 0};
  std::vector<std::string> drawn = draw_coefficients(written, function_key, parameters);
  std::optional<DrawnFunctions> functions;
  if (!written.processes.empty())
    functions.emplace(with_prediction(written, rule).value(), what.solver.method, parameters, function_key);
  for (Process const& process : written.processes) drawn.push_back(fmt::format("function {} drawn from its prior", process.name));
  auto const compiled = functions ? functions->compiled() : session.compiled(what.model, false, what.solver.method, rule);
  Model const& model = compiled->model;

  Experiment experiment;
  experiment.name = task.name;
  bool const rows = model.dynamics == Dynamics::none;
  int const history = data_lag(model);
  std::vector<double> time;  // history included
  for (int i = -history; i < what.samples; ++i) time.push_back(rows ? i + 1 : i * what.step);
  experiment.time.assign(time.begin() + history, time.end());
  experiment.history.assign(model.channels.size(), std::vector<double>(static_cast<std::size_t>(history), 0.0));
  experiment.scored.assign(static_cast<std::size_t>(what.samples), 1);
  experiment.measured.resize(model.channels.size());
  std::vector<std::vector<double>> inputs;
  for (std::size_t i = 0; i < what.inputs.size(); ++i) {
    inputs.push_back(generate(what.inputs[i], what.samples, what.step, {seed, Purpose::input, i + series, 0}));
    std::vector<double> samples(static_cast<std::size_t>(history), 0.0);
    samples.insert(samples.end(), inputs.back().begin(), inputs.back().end());
    InputRule const rule = model.dynamics == Dynamics::continuous ? what.inputs[i].rule : InputRule::zero_order;
    experiment.inputs.push_back(InputSignal(rule, time, std::move(samples)).view(history, what.samples));
  }
  for (std::size_t i = what.inputs.size(); i < model.inputs.size(); ++i)
    experiment.inputs.push_back(
        InputSignal(InputRule::zero_order, time, std::vector<double>(time.size(), 0.0)).view(history, what.samples));
  std::vector<Feedback> feedbacks;
  if (feeds_back) {
    for (auto& channel : experiment.measured) channel.assign(experiment.time.size(), 0.0);
    feedbacks.push_back(measured_samples(*compiled));
  }
  if (functions) feedbacks.push_back(drawn_values(*functions, time, history));
  Trajectory const trajectory(compiled, experiment, what.solver, 0, session.options.execution);
  StreamKey const noise_key{seed, Purpose::noise, series, 0};
  auto const ended = in_rounds(session, task, compiled, experiment, what, parameters, noise_key, feedbacks);
  if (!ended) {
    session.notices << fmt::format("{}: interrupted; --resume starts it again\n", task.name);
    return ExitCode::interrupted;
  }
  Trajectory::Result const& result = *ended;
  if (result.failed() > 0)
    throw UserError(
        {Severity::error,
         "E5001",
         fmt::format("the simulation `{}` {}", task.name,
                     functions ? "does not stay finite" : first_failure(session, what, *compiled, experiment, parameters)),
         Label{task.span, {}},
         {},
         "take smaller steps (substeps = 10), `solver = cvode` where the model is stiff, or other values"});

  for (auto const& channel : result.noisy)
    for (auto const& values : channel)
      if (what.noise_fraction < 0 && std::any_of(values.begin(), values.end(), [](double y) { return std::isnan(y); }))
        throw UserError({Severity::error,
                         "E5001",
                         fmt::format("the noise of the simulation `{}` is impossible at some samples", task.name),
                         Label{task.span, {}},
                         {},
                         "its scale must stay positive along the whole record"});
  if (model.integrated()) check_step(session, task, what, compiled, experiment, parameters, result);
  for (Finding const& finding : drift_findings(session.source, model, result, task.name))
    session.notices << fmt::format("{}: {}{}\n", task.name, finding.severity == Severity::warning ? "warning: " : "",
                                   finding.message);
  for (Finding const& finding : check_ranges(model, experiment, what.solver, 0, parameters, session.options.execution))
    session.notices << fmt::format("{}: warning: {}\n", task.name, finding.message);

  std::string header = rows ? "row" : "t",
              comments = fmt::format("# made by sysid {}: {} of model {}, seed {}\n", SYSID_VERSION, task.name, model.name, seed);
  for (std::size_t p = 0; p < model.parameters.size(); ++p)
    if (what.values[p])
      comments += fmt::format("# {} = {}{}\n", model.parameters[p].name, shortest(model.parameters[p].from_si(*what.values[p])),
                              unit_suffix(model.parameters[p].unit_text()));
  for (std::string const& function : drawn) comments += fmt::format("# {}\n", function);
  std::vector<std::vector<double>> columns = {experiment.time};
  // Channels keep their names; an input of the same name says what it is.
  std::set<std::string> taken = {header};
  auto const column_name = [&taken](std::string name, std::string const& suffix) {
    if (taken.contains(name)) name += suffix;
    while (!taken.insert(name).second) name += "_";
    return name;
  };
  std::vector<std::pair<std::string, std::string>> channel_columns;  // measured, without noise; by quantity
  for (TrajectoryQuantity const& quantity : trajectory.quantities()) {
    channel_columns.emplace_back();
    if (quantity.channel < 0) continue;
    channel_columns.back().first = column_name(quantity.name, "_measured");
    channel_columns.back().second = column_name(channel_columns.back().first + "_clean", "");
  }
  for (std::size_t i = 0; i < what.inputs.size(); ++i) {
    std::string const name = column_name(model.inputs[i].name, "_input");
    header += "," + csv_field(name);
    comments +=
        fmt::format("# column {}{}{}\n", name, unit_suffix(model.inputs[i].unit_text()),
                    model.dynamics == Dynamics::continuous ? fmt::format(": {} between samples", rule_name(what.inputs[i].rule))
                                                           : std::string());
    for (double& value : inputs[i]) value = model.inputs[i].from_si(value);
    columns.push_back(inputs[i]);
  }
  if (history > 0) comments += "# before the first row all inputs and measured samples are 0\n";
  for (std::size_t q = 0; q < trajectory.quantities().size(); ++q) {
    TrajectoryQuantity const& quantity = trajectory.quantities()[q];
    std::vector<double> const& clean = result.values[q][0];
    if (quantity.channel < 0) continue;
    std::vector<double> noisy = result.noisy[static_cast<std::size_t>(quantity.channel)][0];
    if (what.noise_fraction >= 0) {
      double const sd = what.noise_fraction * std::sqrt(population_variance(clean));
      Stream stream(noise_key.at(series, static_cast<std::uint64_t>(quantity.channel)));
      for (std::size_t i = 0; i < clean.size(); ++i) noisy[i] = clean[i] + sd * stream.normal();
      comments += fmt::format("# noise sd of {}: {}{}\n", quantity.name, shortest(sd), unit_suffix(quantity.unit));
    }
    auto const& [measured, noiseless] = channel_columns[q];
    header += fmt::format(",{},{}", csv_field(measured), csv_field(noiseless));
    comments += fmt::format("# column {}{}: measured; {}: without {}noise\n", measured, unit_suffix(quantity.unit), noiseless,
                            feeds_back ? "the sample's own " : "");
    columns.push_back(std::move(noisy));
    columns.push_back(clean);
  }
  std::string text = comments + header + "\n";
  for (std::size_t i = 0; i < experiment.time.size(); ++i)
    for (std::size_t c = 0; c < columns.size(); ++c) text += shortest(columns[c][i]) + (c + 1 == columns.size() ? "\n" : ",");

  auto const folder = session.result_folder(task);
  write_file(folder / what.file, text);
  session.notices << fmt::format("{}: {} samples of {} written to {}\n", task.name, what.samples, model.name,
                                 (folder / what.file).string());
  warn_of_older_data(session, task, folder / what.file);
  return ExitCode::success;
}

}  // namespace sysid
