// `simulate`: data made from stated values, as a CSV that a data block reads.
#include "app/task/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>

#include "app/process/drawn_functions.hpp"
#include "app/session/results.hpp"
#include "app/session/session.hpp"
#include "app/task/signals.hpp"
#include "app/task/simulation_rounds.hpp"
#include "check/checked/task_kinds.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "core/system/memory.hpp"
#include "core/system/progress_terminal.hpp"
#include "core/text/number.hpp"
#include "diagnostics/drift.hpp"
#include "diagnostics/function_ranges.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/particle/drawn_disturbances.hpp"
#include "likelihood/trajectory.hpp"
#include "report/file/simulated_csv.hpp"

namespace sysid {
namespace {

// Made data carry the error of the integrator: said when it is more than a tenth of noise in percent of the response, or else, with
// the model's own noise or none, than a thousandth of the response.
void check_step(Session& session, Task const& task, SimulateTask const& what, std::shared_ptr<CompiledModel const> const& compiled,
                Experiment const& experiment, LaneArray const& parameters, Trajectory::Result const& result) {
  Trajectory const finer(compiled, experiment, what.solver.finer(), 0, session.abandonable());
  Trajectory::Result const fine = finer.run(parameters, {});
  stop_if_interrupted();
  char const* const severity = what.solver.as_model ? "" : "warning: ";
  if (fine.failed() > 0) {
    session.notices << fmt::format("{}: {}with {} the simulation fails, so the error of the chosen solver is not known\n",
                                   task.name, severity, what.solver.finer_words());
    return;
  }
  double const tolerable = what.noise_fraction > 0 ? 0.1 * what.noise_fraction : 1e-3;
  for (std::size_t q = 0; q < finer.quantities().size(); ++q) {
    if (finer.quantities()[q].channel < 0) continue;
    std::vector<double> difference = result.values[q][0];
    for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= fine.values[q][0][i];
    double const share = std::sqrt(population_variance(difference)) / std::sqrt(population_variance(fine.values[q][0]));
    if (share > tolerable)
      session.notices << fmt::format("{}: {}with {}, {} changes by {:.2g} % of its sd{}\n", task.name, severity,
                                     what.solver.finer_words(), finer.quantities()[q].name, 100 * share,
                                     what.solver.as_model ? "; the solver is part of the model"
                                                          : fmt::format("; add `{}` or finer", what.solver.finer().option()));
  }
}

SolverSettings smaller_steps(SolverSettings solver) {
  solver.substeps = std::min(10 * solver.substeps, 10000);
  return solver;
}

// "does not stay finite: `y^3` (duffing.sysid:10:27) at t = 0.1 s"; the place is left out when the failure cannot be repeated.
std::string first_failure(Session const& session, SimulateTask const& what, CompiledModel const& compiled, Experiment experiment,
                          LaneArray const& parameters) {
  // A solve is looked into up to the last sample to score: the states on the way, not what they would be compared with.
  for (auto& channel : experiment.measured) {
    channel.assign(experiment.time.size(), std::nan(""));
    channel.back() = 0;
  }
  Simulator const simulator(compiled.likelihood, Schedule(*compiled.likelihood, experiment, what.solver), session.abandonable());
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
    if (!lagged_samples(model, c).empty()) return true;
  return false;
}

// With another output folder a data block that reads `results/NAME/FILE` still reads what an earlier run left there.
void warn_of_older_data(Session& session, Task const& task, std::filesystem::path const& written) {
  auto const absolute = [](std::filesystem::path const& path) { return std::filesystem::absolute(path).lexically_normal(); };
  for (DataBlock const& block : session.file.data) {
    std::filesystem::path const read = session.folder() / block.path;
    bool const same_name = read.filename() == written.filename() && read.parent_path().filename() == task.name;
    if (same_name && absolute(read) != absolute(written))
      session.notices << fmt::format("{}: warning: data `{}` reads {}, not the file written by this task\n", task.name, block.name,
                                     read.string());
  }
}

/// One simulate task: what it runs along, the run, what is noted of it, its record.
class Simulate {
 public:
  Simulate(Session& session, Task const& task, SimulateTask const& what)
      : session_(session),
        task_(task),
        what_(what),
        written_(session.file.models[static_cast<std::size_t>(what.model)]),
        feeds_back_(what.noise_fraction < 0 && reads_samples(written_)),
        seed_(session.seed(task, what.seed)),
        series_(ordinal() << 32),
        noise_key_{seed_, Purpose::noise, series_, 0},
        parameters_(static_cast<int>(written_.parameters.size()), 1) {
    // Noise in percent is added to a response without noise.
    PredictionRule const rule =
        written_.dynamics == Dynamics::discrete && !feeds_back_ ? PredictionRule::free_run : PredictionRule::as_written;
    for (std::size_t p = 0; p < written_.parameters.size(); ++p)
      parameters_(static_cast<int>(p), 0) = what.values[p].value_or(std::nan(""));
    StreamKey const function_key{seed_, Purpose::prior, series_, 0};
    drawn_ = draw_coefficients(written_, function_key, parameters_);
    if (!written_.processes.empty())
      functions_.emplace(with_prediction(written_, rule).value(), what.solver.method, parameters_, function_key);
    for (Process const& process : written_.processes)
      drawn_.push_back(fmt::format("function {} drawn from its prior", process.name));
    FitTask own;
    own.model = what.model;
    compiled_ = functions_ ? functions_->compiled() : session.compiled(own, false, what.solver.method, rule);
    history_ = data_lag(model());
    require_memory(fmt::format("the simulation `{}` of {} samples", task_.name, what_.samples),
                   bytes_to_simulate(what_, *compiled_), "use fewer samples");
    NothingToKeep const guard;
    prepare();
    if (written_.filtered()) draw_what_is_random();
  }

  ExitCode run() {
    std::optional<NothingToKeep> until_written(std::in_place);
    std::vector<Feedback> feedbacks;
    if (feeds_back_) {
      for (auto& channel : experiment_.measured) channel.assign(experiment_.time.size(), 0.0);
      feedbacks.push_back(measured_samples(*compiled_));
    }
    if (functions_) feedbacks.push_back(drawn_values(*functions_, time_, history_));
    Trajectory const trajectory(compiled_, experiment_, what_.solver, 0, session_.abandonable());
    announce(trajectory);
    auto const ended = in_rounds(session_, task_, compiled_, experiment_, what_, parameters_, noise_key_, feedbacks);
    if (!ended) throw Interrupted();
    require_numbers(*ended);
    note_findings(*ended);
    auto const path = session_.result_folder(task_) / what_.file;
    std::string const text = record(trajectory.quantities(), *ended);
    until_written.reset();
    write_file(path, text);
    // Results of another task of this name; on a full disk they are still there.
    if (session_.options.force) remove_earlier(session_.result_folder(task_), path);
    session_.notices << fmt::format("{}: {} samples of {} written to {}\n", task_.name, what_.samples, model().name, path.string());
    warn_of_older_data(session_, task_, path);
    return ExitCode::success;
  }

 private:
  Model const& model() const { return compiled_->model; }
  // What takes long or much is said before it begins; the time is that of the beginning, scaled.
  void announce(Trajectory const& whole) const {
    constexpr int beginning = 20'000;
    if (what_.samples < 10 * beginning) return;
    auto const history = static_cast<std::size_t>(history_);
    Experiment part = experiment_;
    part.time.resize(beginning);
    part.scored.resize(beginning);
    for (auto& channel : part.measured)
      if (!channel.empty()) channel.resize(beginning);
    std::vector<double> const time(time_.begin(), time_.begin() + history_ + beginning);
    for (std::size_t i = 0; i < part.inputs.size(); ++i) {
      std::vector<double> samples(history, 0.0);
      if (i < inputs_.size()) samples.insert(samples.end(), inputs_[i].begin(), inputs_[i].begin() + beginning);
      samples.resize(time.size(), 0.0);
      bool const held = i >= inputs_.size() || model().dynamics != Dynamics::continuous;
      part.inputs[i] =
          InputSignal(held ? InputRule::zero_order : what_.inputs[i].rule, time, std::move(samples)).view(history_, beginning);
    }
    auto const began = std::chrono::steady_clock::now();
    Trajectory const trajectory(compiled_, part, what_.solver, 0, session_.abandonable());
    (void)trajectory.run(parameters_, noise_key_);
    std::chrono::duration<double> const took = std::chrono::steady_clock::now() - began;
    // With finer steps once more, at about twice the cost; writing takes some hundred nanoseconds a number.
    double const seconds = static_cast<double>(what_.samples) * (took.count() / beginning * (model().integrated() ? 3 : 1) +
                                                                 3e-7 * static_cast<double>(whole.quantities().size()));
    if (seconds > 10 || bytes_to_simulate(what_, *compiled_) > 1e9)
      session_.notices << fmt::format("{}: {} samples take about {} of memory and {}\n", task_.name, what_.samples,
                                      format_bytes(bytes_to_simulate(what_, *compiled_)), format_duration(seconds));
  }

  bool rows() const { return model().dynamics == Dynamics::none; }

  // Several records made in one run with one seed are different records.
  std::uint64_t ordinal() const {
    std::uint64_t count = 0;
    for (Task const& each : session_.file.tasks) {
      if (&each == &task_) break;
      if (kind_of(each) == TaskKind::simulate) ++count;
    }
    return count;
  }

  // The experiment that the model is simulated along.
  void prepare() {
    auto const history = static_cast<std::size_t>(history_);
    for (int i = -history_; i < what_.samples; ++i) time_.push_back(rows() ? i + 1 : i * what_.step);
    experiment_.name = task_.name;
    experiment_.time.assign(time_.begin() + history_, time_.end());
    experiment_.history.assign(model().channels.size(), std::vector<double>(history, 0.0));
    experiment_.scored.assign(static_cast<std::size_t>(what_.samples), 1);
    experiment_.measured.resize(model().channels.size());
    for (std::size_t i = 0; i < what_.inputs.size(); ++i) {
      inputs_.push_back(generate(what_.inputs[i], what_.samples, what_.step, {seed_, Purpose::input, i + series_, 0}));
      std::vector<double> samples(history, 0.0);
      samples.insert(samples.end(), inputs_.back().begin(), inputs_.back().end());
      InputRule const rule = model().dynamics == Dynamics::continuous ? what_.inputs[i].rule : InputRule::zero_order;
      experiment_.inputs.push_back(InputSignal(rule, time_, std::move(samples)).view(history_, what_.samples));
    }
    for (std::size_t i = what_.inputs.size(); i < model().inputs.size(); ++i)
      experiment_.inputs.push_back(
          InputSignal(InputRule::zero_order, time_, std::vector<double>(time_.size(), 0.0)).view(history_, what_.samples));
  }

  void draw_what_is_random() {
    DrawnDisturbances drawn = draw_disturbances(model(), parameters_, experiment_, {seed_, Purpose::disturbance, series_, 0},
                                                what_.solver.fixed_step() ? what_.solver.substeps : 1);
    experiment_ = std::move(drawn.experiment);
    compiled_ = compile(std::move(drawn.model), false, what_.solver.method);
  }

  void require_numbers(Trajectory::Result const& result) const {
    auto const failed = [&](std::string message, std::string help) {
      return UserError({Severity::error, "E5001", std::move(message), Label{task_.span, {}}, {}, std::move(help)});
    };
    if (result.failed() > 0)
      throw failed(
          fmt::format("the simulation `{}` {}", task_.name,
                      functions_ ? "does not stay finite" : first_failure(session_, what_, *compiled_, experiment_, parameters_)),
          what_.solver.row().exact    ? fmt::format("use other values of the parameters, or {} if the motion is too fast for `{}`",
                                                    what_.solver.other_methods(), what_.solver.method)
          : what_.solver.fixed_step() ? fmt::format("use smaller steps (`{}`), {}, or other values of the parameters",
                                                    smaller_steps(what_.solver).option(), what_.solver.other_methods())
          : what_.solver.other_methods().empty()
              ? fmt::format("use other values of the parameters, or more `steps` (now {})", what_.solver.steps)
              : fmt::format("use {}, more `steps` (now {}), or other values of the parameters", what_.solver.other_methods(),
                            what_.solver.steps));
    for (auto const& channel : result.noisy)
      for (auto const& values : channel)
        if (what_.noise_fraction < 0 && std::any_of(values.begin(), values.end(), [](double y) { return std::isnan(y); }))
          throw failed(fmt::format("the noise of the simulation `{}` is impossible at some samples", task_.name),
                       "its scale must stay positive along the whole record");
  }

  void note_findings(Trajectory::Result const& result) {
    if (model().integrated() && !what_.solver.row().exact)
      check_step(session_, task_, what_, compiled_, experiment_, parameters_, result);
    for (Finding const& finding : drift_findings(session_.source, model(), result, task_.name))
      session_.notices << fmt::format("{}: {}{}\n", task_.name, finding.severity == Severity::warning ? "warning: " : "",
                                      finding.message);
    for (Finding const& finding : check_ranges(model(), experiment_, what_.solver, 0, parameters_, session_.abandonable()))
      session_.notices << fmt::format("{}: warning: {}\n", task_.name, finding.message);
  }

  // The columns of a channel: as measured, and without noise; none of what is no channel.
  struct ChannelColumns {
    std::string measured, clean;
  };

  std::string record(std::vector<TrajectoryQuantity> const& quantities, Trajectory::Result const& result) {
    MadeRecord record(rows() ? "row" : "t", experiment_.time);
    record.comment(fmt::format("made by sysid {}: {} of model {}, seed {}", SYSID_VERSION, task_.name, model().name, seed_));
    for (std::size_t p = 0; p < model().parameters.size(); ++p)
      if (what_.values[p]) {
        Parameter const& parameter = model().parameters[p];
        record.comment(fmt::format("{} = {}{}", parameter.name, shortest(parameter.from_si(*what_.values[p])),
                                   unit_suffix(parameter.unit_text())));
      }
    for (std::string const& function : drawn_) record.comment(function);
    // Channels keep their names; an input of the same name says what it is.
    std::vector<ChannelColumns> names(quantities.size());
    for (std::size_t q = 0; q < quantities.size(); ++q) {
      if (quantities[q].channel < 0) continue;
      names[q].measured = record.take_name(quantities[q].name, "_measured");
      names[q].clean = record.take_name(names[q].measured + "_clean", "");
    }
    add_inputs(record);
    if (history_ > 0) record.comment("before the first row all inputs and measured samples are 0");
    for (std::size_t q = 0; q < quantities.size(); ++q)
      if (quantities[q].channel >= 0) add_channel(record, quantities[q], names[q], result.values[q][0], result);
    return record.text();
  }

  void add_inputs(MadeRecord& record) {
    for (std::size_t i = 0; i < what_.inputs.size(); ++i) {
      Quantity const& input = model().inputs[i];
      std::string const name = record.take_name(input.name, "_input");
      record.comment(fmt::format("column {}{}{}", name, unit_suffix(input.unit_text()),
                                 model().dynamics == Dynamics::continuous
                                     ? fmt::format(": {} between samples", rule_name(what_.inputs[i].rule))
                                     : std::string()));
      for (double& value : inputs_[i]) value = input.from_si(value);
      record.add(name, inputs_[i]);
    }
  }

  void add_channel(MadeRecord& record, TrajectoryQuantity const& quantity, ChannelColumns const& names,
                   std::vector<double> const& clean, Trajectory::Result const& result) const {
    std::vector<double> noisy = result.noisy[static_cast<std::size_t>(quantity.channel)][0];
    if (what_.noise_fraction >= 0) {
      double const sd = what_.noise_fraction * std::sqrt(population_variance(clean));
      Stream stream(noise_key_.at(series_, static_cast<std::uint64_t>(quantity.channel)));
      for (std::size_t i = 0; i < clean.size(); ++i) noisy[i] = clean[i] + sd * stream.normal();
      record.comment(fmt::format("noise sd of {}: {}{}", quantity.name, shortest(sd), unit_suffix(quantity.unit)));
    }
    record.comment(fmt::format("column {}{}: measured; {}: without {}noise", names.measured, unit_suffix(quantity.unit),
                               names.clean, feeds_back_ ? "the sample's own " : ""));
    record.add(names.measured, std::move(noisy));
    record.add(names.clean, clean);
  }

  Session& session_;
  Task const& task_;
  SimulateTask const& what_;
  Model const& written_;
  bool const feeds_back_;
  std::uint64_t const seed_, series_;
  StreamKey const noise_key_;
  LaneArray parameters_;
  std::vector<std::string> drawn_;  // functions, for the head of the record
  std::optional<DrawnFunctions> functions_;
  std::shared_ptr<CompiledModel const> compiled_;
  int history_ = 0;           // samples before the record that the model reads
  std::vector<double> time_;  // history included
  std::vector<std::vector<double>> inputs_;
  Experiment experiment_;
};

}  // namespace

ExitCode run_simulate(Session& session, Task const& task, SimulateTask const& what) { return Simulate(session, task, what).run(); }

}  // namespace sysid
