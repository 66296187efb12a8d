// Chunks of rows through the simulator, each beginning with the row that the one before ended with.
#include "tracking/tracker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "core/text/diagnostic.hpp"
#include "linear_algebra/decompositions.hpp"

namespace sysid {
namespace {

constexpr int rows_at_once = 1024, after_an_outlier = 32;  // what was simulated beyond an outlier is lost
/// The size of a jump is found on equations that are linearised as they were without it, and for the likeliest row: of 50 jumps by
/// a tenth the errors were 2.0 of the sds that this gives.
constexpr double beyond_linear = 2;
constexpr int most_lags = 1000;   // of a model that looks back
constexpr double far_off = 8;     // expected sds: no sample of a right model
constexpr int most_in_a_row = 2;  // samples of a channel; more, one after the other, are a change

/// With a column for every channel: an experiment may lack those that come last.
Schedule schedule_of(TrackedProgram const& program, Experiment experiment, SolverSettings const& solver) {
  experiment.measured.resize(program.channels.size());
  if (program.program->source.map) return {*program.program, experiment, SolverSettings{}};
  return {*program.program, experiment, solver};
}

LaneArray parameters_of(TrackedProgram const& program, std::span<double const> intensities, std::span<double const> moments) {
  LaneArray all(program.tracked + program.moments, 1);
  for (int j = 0; j < program.tracked; ++j) all(j, 0) = intensities.empty() ? 0 : intensities[static_cast<std::size_t>(j)];
  for (int m = 0; m < program.moments; ++m) all(program.tracked + m, 0) = moments[static_cast<std::size_t>(m)];
  return all;
}

/// Records of all rows of an experiment [rows x records]; false where they are not finite.
bool records_along(TrackedProgram const& program, SolverSettings const& solver, ExecutionOptions const& execution,
                   Experiment const& experiment, LaneArray const& parameters, LaneArray& records) {
  int const rows = static_cast<int>(experiment.time.size());
  Simulator const simulator(program.program, schedule_of(program, experiment, solver), execution);
  records = LaneArray(rows * program.records, 1);
  Outcome outcome;
  simulator.records(parameters, 0, rows, records, {&outcome, 1});
  return outcome.ok;
}

UserError diverged(Experiment const& experiment, std::int64_t row) {
  return UserError({Severity::error,
                    "",
                    fmt::format("the filter has no finite values at row {} of {}", row, experiment.name),
                    std::nullopt,
                    {},
                    "the model diverges on these rows: check the record there, use a smaller --drift, or fit the model again"});
}

}  // namespace

std::vector<double> moments_of(TrackedProgram const& program, StatePrior const& states, TrackedPrior const& parameters) {
  std::vector<double> moments(static_cast<std::size_t>(program.moments));
  for (int i = 0; i < program.size(); ++i) {
    bool const state = i < program.states;
    moments[static_cast<std::size_t>(i)] = state ? states.mean(i) : parameters.mean(i - program.states);
    for (int j = 0; j <= i; ++j)
      if (int const place = program.place(i, j); place >= 0 && state == (j < program.states))
        moments[static_cast<std::size_t>(place)] =
            state ? states.covariance(i, j) : parameters.covariance(i - program.states, j - program.states);
  }
  return moments;
}

Tracker::Tracker(TrackedProgram program, SolverSettings solver, ExecutionOptions execution, TrackedPrior parameters,
                 StatePrior states, TrackingOptions options)
    : program_(std::move(program)),
      solver_(std::move(solver)),
      execution_(execution),
      prior_(std::move(parameters)),
      options_(std::move(options)),
      detector_(program_.states, program_.tracked, options_.false_alarms, options_.window),
      moments_(moments_of(program_, states, prior_)),
      settling_(states.settles ? options_.settling_rows : 0) {
  detector_.set_scales(options_.scales);
  row_.tracked = static_cast<std::size_t>(program_.tracked);
  row_.mean.resize(static_cast<std::size_t>(program_.size()));
  row_.sd = row_.mean;
  row_.innovation.resize(program_.channels.size());
  row_.expected = row_.innovation;
  row_.left_out.assign(program_.channels.size(), 0);
  left_out_in_a_row_.assign(program_.channels.size(), 0);
}

void Tracker::take(Experiment const& experiment, int from, Sink const& sink, std::int64_t rows_before) {
  rows_before_ = rows_before;
  int const rows = static_cast<int>(experiment.time.size());
  while (from < rows) {
    stop_if_interrupted();
    int const block = block_;
    block_ = std::min(2 * block_, rows_at_once);
    from = take_some(experiment, from, std::min(rows, from + block), sink);
  }
}

/// Up to the first alarm; returns the row to go on with.
int Tracker::take_some(Experiment const& experiment, int from, int to, Sink const& sink) {
  bool const begins = rows_ == 0;
  int const first = begins ? from : from - 1;
  Experiment part = slice(experiment, first, to, static_cast<int>(std::min<std::int64_t>(most_lags, row_of(experiment, first))));
  if (!begins) part.scored.front() = 0;  // it has corrected the moments
  if (left_out_row_ == row_of(experiment, from))
    for (std::size_t c = 0; c < part.measured.size(); ++c)
      if (row_.left_out[c] != 0) part.measured[c][static_cast<std::size_t>(from - first)] = std::nan("");
  LaneArray records;
  bool const fine =
      records_along(program_, solver_, execution_, part, parameters_of(program_, options_.intensities, moments_), records);
  if (!fine) {
    // Rows before it are known to be good.
    if (to - from == 1) throw diverged(experiment, row_of(experiment, from));
    int const half = from + (to - from) / 2;
    return take_some(experiment, from, half, sink);
  }
  for (int index = from; index < to; ++index) {
    double const* const row = records.view().data() + static_cast<std::ptrdiff_t>(index - first) * program_.records;
    if (leaves_out(experiment, index, row)) return index;
    if (read(experiment, index, row, sink)) return index + 1;
  }
  return to;
}

/// True where samples of the row are to be left out: it is then filtered once more, without them. A change of a parameter as large
/// as that is found two samples later.
bool Tracker::leaves_out(Experiment const& experiment, int index, double const* records) {
  std::int64_t const row = row_of(experiment, index);
  if (left_out_row_ == row) return false;  // without them it still comes here
  std::ranges::fill(row_.left_out, 0);
  if (!options_.leaves_out || settling_ > 0) return false;
  bool any = false;
  for (std::size_t c = 0; c < program_.channels.size(); ++c) {
    auto const& channel = program_.channels[c];
    double const innovation = records[channel.innovation], variance = records[channel.variance];
    if (std::isnan(innovation) || !(variance > 0)) continue;
    double const sds = innovation / std::sqrt(variance);
    if (std::fabs(sds) <= far_off) {
      left_out_in_a_row_[c] = 0;
    } else if (left_out_in_a_row_[c] < most_in_a_row) {
      ++left_out_in_a_row_[c];
      row_.left_out[c] = sds;
      any = true;
    }
  }
  if (!any) return false;
  block_ = after_an_outlier;
  left_out_row_ = row;
  return true;
}

/// True where the moments are no longer those of the records.
bool Tracker::read(Experiment const& experiment, int index, double const* records, Sink const& sink) {
  if (rows_ > 0) detector_.move(records + program_.transition);
  for (auto const& channel : program_.channels) {
    if (std::isnan(records[channel.innovation])) continue;
    if (!(records[channel.variance] > 0)) throw diverged(experiment, row_of(experiment, index));
    detector_.observe({records[channel.innovation], records[channel.variance], records + channel.slopes, records + channel.gains});
  }
  std::copy_n(records + program_.after, program_.moments, moments_.begin());
  ++rows_;
  bool changed = false;
  bool const settling = settling_ > 0;
  std::optional<Alarm> alarm;
  if (settling) {
    if (--settling_ == 0) settle(), changed = true;
  } else if (auto const jump = detector_.detect()) {
    alarm = respond(experiment, index, *jump);
    changed = true;
  }
  report(experiment, index, records, row_);
  row_.settling = settling;
  row_.alarm = alarm ? &*alarm : nullptr;
  if (settling_ == 0) {
    scratch_.clear();
    for (int j = 0; j < program_.tracked; ++j) scratch_.push_back(variance(program_.states + j));
    detector_.keep(rows_, {moments_.data() + program_.states, static_cast<std::size_t>(program_.tracked)}, scratch_);
    times_.emplace_back(row_of(experiment, index), experiment.time[static_cast<std::size_t>(index)]);
    if (times_.size() > 4 * static_cast<std::size_t>(options_.window))
      times_.erase(times_.begin(), times_.end() - options_.window - 1);
  }
  sink(row_);
  return changed;
}

void Tracker::report(Experiment const& experiment, int index, double const* records, TrackedRow& row) {
  row.row = row_of(experiment, index);
  row.time = experiment.time[static_cast<std::size_t>(index)];
  for (int i = 0; i < program_.states; ++i) {
    row.mean[static_cast<std::size_t>(i)] = moments_[static_cast<std::size_t>(i)];
    row.sd[static_cast<std::size_t>(i)] = std::sqrt(std::max(0.0, variance(i)));
  }
  values_now(row.mean, row.sd);
  row.squared = 0;
  row.samples = 0;
  for (std::size_t c = 0; c < program_.channels.size(); ++c) {
    double const innovation = records[program_.channels[c].innovation];
    row.innovation[c] = innovation;
    row.expected[c] = std::sqrt(records[program_.channels[c].variance]);
    if (std::isnan(innovation)) continue;
    row.squared += innovation * innovation / records[program_.channels[c].variance];
    ++row.samples;
  }
}

void Tracker::values_now(std::vector<double>& mean, std::vector<double>& sd) {
  std::vector<double> values(2 * static_cast<std::size_t>(program_.tracked));
  run_scalar(program_.values, {moments_.data() + program_.states, static_cast<std::size_t>(program_.tracked)}, values);
  for (int j = 0; j < program_.tracked; ++j) {
    auto const at = static_cast<std::size_t>(program_.states + j);
    mean[at] = values[static_cast<std::size_t>(j)];
    sd[at] =
        std::fabs(values[static_cast<std::size_t>(program_.tracked + j)]) * std::sqrt(std::max(0.0, variance(program_.states + j)));
  }
}

std::pair<double, double> Tracker::value_of(int parameter, double mean, double variance) const {
  std::vector<double> coordinates(moments_.begin() + program_.states, moments_.begin() + program_.size());
  coordinates[static_cast<std::size_t>(parameter)] = mean;
  std::vector<double> values(2 * coordinates.size());
  run_scalar(program_.values, coordinates, values);
  return {values[static_cast<std::size_t>(parameter)],
          std::fabs(values[coordinates.size() + static_cast<std::size_t>(parameter)]) * std::sqrt(std::max(0.0, variance))};
}

/// The parameters become those of the prior again; the states given the parameters stay as the rows have made them. With
/// x = m + G (theta - mu) + r, r of covariance P - G C', and theta ~ N(mu0, P0),
///   m <- m + G (mu0 - mu),  P <- P - G C' + G P0 G',  C <- G P0.
void Tracker::settle() {
  int const n = program_.states, p = program_.tracked;
  if (n == 0 || p == 0) return;
  Eigen::MatrixXd whole(n + p, n + p);
  for (int i = 0; i < n + p; ++i)
    for (int j = 0; j < n + p; ++j) whole(i, j) = program_.place(i, j) < 0 ? 0 : moment(i, j);
  Eigen::MatrixXd const cross = whole.topRightCorner(n, p);
  Eigen::MatrixXd const gain = cross * inverse(whole.bottomRightCorner(p, p));
  Eigen::VectorXd const shift = prior_.mean - Eigen::Map<Eigen::VectorXd const>(moments_.data() + n, p);
  Eigen::VectorXd const mean = Eigen::Map<Eigen::VectorXd const>(moments_.data(), n) + gain * shift;
  Eigen::MatrixXd const covariance =
      whole.topLeftCorner(n, n) - gain * cross.transpose() + gain * prior_.covariance * gain.transpose();
  moments_ = moments_of(program_, {mean, covariance, false}, prior_);
  Eigen::MatrixXd const together = gain * prior_.covariance;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < p; ++j)
      if (program_.place(i, n + j) >= 0) moment(i, n + j) = together(i, j);
}

/// The filter is moved to where the jump takes it, and less sure by the variance of that.
Alarm Tracker::respond(Experiment const& experiment, int index, DetectedJump const& jump) {
  Alarm alarm;
  double const variance_of_size = std::pow(beyond_linear * jump.sd, 2);
  alarm.parameter = jump.parameter;
  alarm.row = row_of(experiment, index);
  alarm.time = experiment.time[static_cast<std::size_t>(index)];
  // times_ ends with the row before this one, which is the rows_ - 1st.
  auto const back = static_cast<std::size_t>(rows_ - 1 - jump.row);
  alarm.onset_row = times_[times_.size() - 1 - std::min(back, times_.size() - 1)].first;
  alarm.statistic = jump.statistic;
  alarm.other = jump.other;
  alarm.other_statistic = jump.other_statistic;
  std::tie(alarm.before, alarm.before_sd) = value_of(jump.parameter, jump.mean_before, jump.variance_before);
  for (int i = 0; i < program_.size(); ++i) {
    moments_[static_cast<std::size_t>(i)] += jump.moves[static_cast<std::size_t>(i)] * jump.size;
    for (int j = 0; j <= i; ++j)
      if (program_.place(i, j) >= 0)
        moment(i, j) += jump.moves[static_cast<std::size_t>(i)] * jump.moves[static_cast<std::size_t>(j)] * variance_of_size;
  }
  int const entry = program_.states + jump.parameter;
  std::tie(alarm.after, alarm.after_sd) = value_of(jump.parameter, moments_[static_cast<std::size_t>(entry)], variance(entry));
  detector_.forget();
  return alarm;
}

StatePrior states_along(TrackedProgram const& program, SolverSettings const& solver, ExecutionOptions const& execution,
                        Experiment const& experiment, StatePrior const& first, TrackedPrior const& parameters, bool corrects) {
  TrackedPrior known = parameters;
  known.covariance.setZero();
  Experiment along = experiment;
  if (!corrects) std::fill(along.scored.begin(), along.scored.end(), std::uint8_t{0});
  LaneArray records;
  int const rows = static_cast<int>(along.time.size()), n = program.states;
  StatePrior prior{Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n), true};
  if (!records_along(program, solver, execution, along, parameters_of(program, {}, moments_of(program, first, known)), records))
    throw diverged(experiment, experiment.first_row);
  Eigen::MatrixXd path(n, rows);
  for (int i = 0; i < rows; ++i)
    for (int s = 0; s < n; ++s) path(s, i) = records(i * program.records + program.after + s, 0);
  prior.mean = path.rowwise().mean();
  path.colwise() -= prior.mean;
  prior.covariance = 4 * path * path.transpose() / rows;
  return prior;
}

SolverSettings steps_for_tracking(SolverSettings const& solver) {
  SolverRow const& row = solver.row();
  if (solver.fixed_step() && !row.exact && row.in_program) return solver;
  SolverSettings fixed;
  fixed.method = "rk4";
  return fixed;
}

SolverSettings tracking_solver(TrackedProgram const& program, SolverSettings solver, ExecutionOptions const& execution,
                               Experiment const& experiment, StatePrior const& first, TrackedPrior const& parameters) {
  if (program.program->source.map || solver.as_model) return solver;
  constexpr int rows_compared = 400;
  int const most_substeps = std::max(64, 2 * solver.substeps);  // those of the fit are compared once, however many
  Experiment const part = slice(experiment, 0, std::min<int>(rows_compared, static_cast<int>(experiment.time.size())), 0);
  LaneArray const start = parameters_of(program, {}, moments_of(program, first, parameters));
  LaneArray coarse, fine;
  bool solved = records_along(program, solver, execution, part, start, coarse);
  for (; solver.substeps < most_substeps; solver.substeps *= 2) {
    SolverSettings finer = solver;
    finer.substeps *= 2;
    bool const now = records_along(program, finer, execution, part, start, fine);
    bool agree = solved && now;
    for (int i = 0; agree && i < static_cast<int>(part.time.size()); ++i)
      for (auto const& channel : program.channels) {
        int const row = i * program.records;
        if (std::isnan(fine(row + channel.innovation, 0))) continue;
        double const apart = std::fabs(coarse(row + channel.innovation, 0) - fine(row + channel.innovation, 0));
        agree = agree && apart < 0.01 * std::sqrt(fine(row + channel.variance, 0));
      }
    if (agree) return solver;
    std::swap(coarse, fine);
    solved = now;
  }
  throw UserError(
      {Severity::error,
       "",
       fmt::format("{} steps of {} between two samples are not enough for tracking", most_substeps, solver.method),
       std::nullopt,
       {},
       "the equations are too stiff for the sampling interval: remove the fast dynamics from the model, or sample faster"});
}

}  // namespace sysid
