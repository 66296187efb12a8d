// Draws, simulates with a solver so fine that its error does not show, and puts the samples in the place of those of the record.
#include "app/calibration/made_records.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "app/session/fit_target.hpp"
#include "core/numeric/statistics.hpp"
#include "core/system/interrupt.hpp"
#include "likelihood/particle/drawn_disturbances.hpp"
#include "likelihood/trajectory.hpp"
#include "model/lags.hpp"

namespace sysid {
namespace {

/// Of the sd of a response: what a finer solver may change.
constexpr double settled = 1e-6;
constexpr int most_refinements = 7;
/// Lines of white noise in a sampling interval: a decay of eight per interval loses 0.1 % of its variance.
constexpr int lines_of_noise = 8;

Diagnostic refused(Task const& task, std::string message, std::string help) {
  return {Severity::error, "E6210", std::move(message), Label{task.span, {}}, {}, std::move(help)};
}

/// Whether no channel changes from one solver to a finer one.
bool same_response(Trajectory const& trajectory, Trajectory::Result const& coarse, Trajectory::Result const& fine) {
  for (std::size_t q = 0; q < trajectory.quantities().size(); ++q) {
    if (trajectory.quantities()[q].channel < 0) continue;
    std::vector<double> const &a = coarse.values[q][0], &b = fine.values[q][0];
    double change = 0, largest = 0;
    for (std::size_t i = 0; i < a.size(); ++i) {
      change += (a[i] - b[i]) * (a[i] - b[i]);
      largest = std::max(largest, std::fabs(b[i]));
    }
    double const sd = std::sqrt(population_variance(b));
    if (!(std::sqrt(change / static_cast<double>(a.size())) <= settled * (sd > 0 ? sd : largest))) return false;
  }
  return true;
}

/// Rows that no likelihood reads are not simulated, where they could fail.
Experiment up_to_last_scored(Experiment const& experiment) {
  auto const last = std::find_if(experiment.scored.rbegin(), experiment.scored.rend(), [](std::uint8_t each) { return each != 0; });
  auto const scored = static_cast<std::size_t>(experiment.scored.rend() - last);
  std::size_t const rows = std::max<std::size_t>(scored, 2);  // two make a step
  if (scored == 0 || rows >= experiment.time.size()) return experiment;
  return slice(experiment, 0, static_cast<int>(rows));
}

/// What is made, before it is.
Experiment with_zeros(Experiment experiment) {
  for (std::size_t c = 0; c < experiment.measured.size(); ++c)
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i)
      if (experiment.is_scored(c, i)) experiment.measured[c][i] = 0;
  return experiment;
}

/// Rows of which the likelihood of an experiment reads samples that it does not score, by number in the file: those that are looked
/// back to, and those that a start is estimated from.
std::set<int> rows_only_read(ExperimentData const& data, Model const& model, StartRule start) {
  Experiment const& experiment = data.experiment;
  int const samples = static_cast<int>(experiment.time.size());
  std::set<int> rows;
  auto const read = [&](int channel, int index) {
    auto const c = static_cast<std::size_t>(channel);
    if (index < 0 || !experiment.is_scored(c, static_cast<std::size_t>(index))) rows.insert(experiment.first_row + index);
  };
  for (PastSample const& each : lagged_samples(model, -2)) read(each.channel, -each.lag);
  for (PastSample const& each : lagged_samples(model, -1))
    for (int i = 0; i + 1 < samples; ++i) read(each.channel, i - each.lag);
  for (int c = 0; c < static_cast<int>(experiment.measured.size()); ++c) {
    for (PastSample const& each : lagged_samples(model, c))
      for (int i = 0; i < samples; ++i)
        if (experiment.is_scored(static_cast<std::size_t>(c), static_cast<std::size_t>(i))) read(each.channel, i - each.lag);
    if (start.kind == StartRule::Kind::estimated)
      for (int i = 0; i < std::min(start.rows, samples); ++i) read(c, i);
  }
  return rows;
}

}  // namespace

std::optional<Diagnostic> RecordMaker::refusal(Session const& session, Task const& task, FitTask const& what,
                                               std::vector<ExperimentData> const& data) {
  if (!session.file.models[static_cast<std::size_t>(what.model)].processes.empty())
    return refused(
        task,
        fmt::format(
            "`{}` cannot be calibrated: records of models with a Gaussian process that is integrated out cannot be simulated yet",
            task.name),
        "calibrate a fit of the same model without `gp(...)`, or with a function that is estimated as a finite sum");
  if (Parameter const* improper = session.file.models[static_cast<std::size_t>(what.model)].improper())
    return refused(
        task,
        fmt::format("`{}` cannot be calibrated: records are simulated from draws of the prior, which needs proper priors, but "
                    "the prior of `{}` is {}",
                    task.name, improper->name, improper->prior->row->name),
        fmt::format("give `{}` a wide but proper prior", improper->name));
  // A made sample would still be read as it was measured.
  for (ExperimentData const& each : data) {
    DataBlock const& block = session.file.data[static_cast<std::size_t>(each.use.data)];
    for (DataInputUse const& input : block.inputs)
      for (DataMeasureUse const& measured : block.measured)
        if (input.column == measured.column)
          return refused(
              task,
              fmt::format("`{}` cannot be calibrated: `{}` reads the column `{}` both as an input and as a measured channel",
                          task.name, block.name, input.column),
              "write `lag(measured(...), 1)` in the model instead of the input, so that simulated samples are used");
  }
  // A made sample belongs to one experiment.
  std::set<std::pair<int, std::size_t>> taken;
  for (ExperimentData const& each : data)
    for (std::size_t i = 0; i < each.experiment.scored.size(); ++i) {
      std::size_t const row = i + static_cast<std::size_t>(each.experiment.first_row);
      if (each.experiment.scored[i] != 0 && !taken.insert({each.use.data, row}).second)
        return refused(task,
                       fmt::format("`{}` cannot be calibrated: two of its experiments score row {} of `{}`", task.name, row,
                                   session.file.data[static_cast<std::size_t>(each.use.data)].name),
                       "fit to ranges without common rows");
    }
  // It would be made in one experiment, and as it was measured in the other.
  Model const& written = session.file.models[static_cast<std::size_t>(what.model)];
  Model const model = with_prediction(written, what.prediction).value_or(written);
  for (ExperimentData const& each : data)
    for (int const row : rows_only_read(each, model, what.start))
      if (row > 0 && taken.contains({each.use.data, static_cast<std::size_t>(row)}))
        return refused(
            task,
            fmt::format("`{}` cannot be calibrated: `{}` reads row {} without scoring it, but another of its experiments "
                        "scores this row",
                        task.name, each.experiment.name, row),
            "fit to ranges that lie further apart, or to one of them alone");
  return std::nullopt;
}

RecordMaker::RecordMaker(Session& session, FitTask const& what, std::vector<ExperimentData> const& data)
    : session_(session),
      what_(what),
      data_(data),
      compiled_(session.compiled(what, what.solver.method)),
      space_(parameter_space(compiled_->model, what.experiments)) {}

std::optional<MadeRecords> RecordMaker::make(std::uint64_t seed) const {
  for (int attempt = 0; attempt < most_draws; ++attempt) {
    stop_if_interrupted();
    auto const draw = static_cast<std::uint64_t>(attempt);
    LaneArray theta(space_->dimension(), 1), declared(space_->dimension(), 1);
    space_->sample_prior({seed, Purpose::calibration, draw, 0}, theta);
    space_->constrain(theta, declared);
    // By declared values, as the posterior is compared with them.
    MadeRecords out;
    auto const made =
        samples(space_->values_of_declared(declared), Stream({seed, Purpose::calibration, draw, 1}).bits(), out.settled);
    if (made.empty()) continue;
    out.redrawn = attempt;
    for (int p = 0; p < declared.rows(); ++p) out.truth.push_back(declared(p, 0));
    for (std::size_t e = 0; e < data_.size(); ++e) {
      ExperimentData const& each = data_[e];
      auto found =
          std::find_if(out.of_blocks.begin(), out.of_blocks.end(), [&](auto const& block) { return block.first == each.use.data; });
      if (found == out.of_blocks.end()) found = out.of_blocks.insert(found, {each.use.data, each.record});
      Record& record = found->second;
      record.comments.clear();  // of the record's own true values
      for (std::size_t c = 0; c < record.measured.size(); ++c)
        for (std::size_t i = 0; i < each.experiment.time.size() && !record.measured[c].empty(); ++i)
          if (double& sample = record.measured[c][i + static_cast<std::size_t>(each.experiment.first_row) - 1];
              each.experiment.is_scored(c, i))
            sample = made[e][c][i];
    }
    return out;
  }
  return std::nullopt;
}

std::vector<std::vector<std::vector<double>>> RecordMaker::samples(ConstLanes values, std::uint64_t seed, bool& settled) const {
  std::vector<std::vector<std::vector<double>>> all;
  for (int e = 0; e < static_cast<int>(data_.size()); ++e) {
    LaneArray parameters(static_cast<int>(compiled_->model.parameters.size()), 1);
    space_->select(values, e, parameters);
    auto of_one = samples(e, parameters, {seed, Purpose::noise, static_cast<std::uint64_t>(e), 0}, settled);
    if (!of_one) return {};
    all.push_back(std::move(*of_one));
  }
  return all;
}

std::optional<std::vector<std::vector<double>>> RecordMaker::samples(int e, ConstLanes parameters, StreamKey noise,
                                                                     bool& settled) const {
  Experiment const experiment = up_to_last_scored(data_[static_cast<std::size_t>(e)].experiment);
  // Streams of noise go by the number of the trajectory, which is 0 here.
  noise.seed = Stream(noise).bits();
  if (predicts_from_data(compiled_->model))
    // Wherever rounds begin they end in the same record. What was measured begins them only where zeros cannot: else it would
    // decide which true values are drawn again.
    if (auto made = samples(with_zeros(experiment), parameters, noise, settled)) return made;
  return samples(experiment, parameters, noise, settled);
}

std::optional<std::vector<std::vector<double>>> RecordMaker::samples(Experiment experiment, ConstLanes parameters, StreamKey noise,
                                                                     bool& settled) const {
  std::shared_ptr<CompiledModel const> compiled = compiled_;
  SolverSettings solver = what_.solver;
  if (compiled_->model.filtered()) {
    bool const continuous = compiled_->model.dynamics == Dynamics::continuous;
    if (continuous && solver.row().exact) solver = {};  // it steps over a whole interval, in which there are several lines
    if (continuous && solver.fixed_step() && !solver.as_model)
      solver.substeps = (solver.substeps + lines_of_noise - 1) / lines_of_noise * lines_of_noise;
    DrawnDisturbances drawn =
        draw_disturbances(compiled_->model, parameters, std::move(experiment), {noise.seed, Purpose::disturbance, noise.index, 0},
                          solver.fixed_step() ? solver.substeps : 1);
    experiment = std::move(drawn.experiment);
    compiled = compile(std::move(drawn.model), compiled_->free_start, solver.method);
  }
  Model const& model = compiled->model;
  bool const refine = model.integrated() && !solver.as_model && !solver.row().exact;
  auto const trajectory_of = [&](SolverSettings const& with) {
    return Trajectory(compiled, experiment, with, start_rows(what_.start), session_.abandonable());
  };
  Trajectory::Result result = trajectory_of(solver).run(parameters, noise);
  bool fine_enough = !refine;
  for (int i = 0; !fine_enough && i < most_refinements && solver.finer().within_limits(); ++i) {
    SolverSettings const coarser = solver;
    solver = solver.finer();
    Trajectory const finer = trajectory_of(solver);
    Trajectory::Result fine = finer.run(parameters, noise);
    // What one solver can follow is not drawn again because a finer one cannot.
    if (result.failed() == 0 && fine.failed() > 0) {
      solver = coarser;
      break;
    }
    fine_enough = result.failed() == 0 && same_response(finer, result, fine);
    result = std::move(fine);
  }
  // What reads measured samples reads made ones: rounds, each of which makes at least one more sample right.
  auto const replace = [&] {
    bool changed = false;
    for (std::size_t c = 0; c < experiment.measured.size(); ++c)
      for (std::size_t i = 0; i < experiment.measured[c].size(); ++i) {
        double& sample = experiment.measured[c][i];
        if (!experiment.is_scored(c, i)) continue;
        double const made = model.channels[c].to_si(result.noisy[c][0][i]);
        if (!std::isfinite(made)) continue;
        changed = changed || made != sample;
        sample = made;
      }
    return changed;
  };
  bool settles = !predicts_from_data(model);
  for (std::size_t round = 0; !settles && result.failed() == 0 && round <= experiment.time.size(); ++round) {
    settles = !replace();
    if (!settles) result = trajectory_of(solver).run(parameters, noise);
  }
  if (!settles || result.failed() > 0) return std::nullopt;
  settled = settled && fine_enough;
  std::vector<std::vector<double>> made;
  for (std::size_t c = 0; c < experiment.measured.size(); ++c) {
    made.push_back(result.noisy[c][0]);
    for (double& each : made.back()) each = model.channels[c].to_si(each);
    for (std::size_t i = 0; i < experiment.measured[c].size(); ++i)
      if (experiment.is_scored(c, i) && !std::isfinite(made.back()[i])) return std::nullopt;
  }
  return made;
}

}  // namespace sysid
