// Chunks of rows through the simulator, each beginning with the row that the one before ended with.
#include "tracking/tracker.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/numeric/not_finite.hpp"
#include "core/system/interrupt.hpp"
#include "linear_algebra/decompositions.hpp"
#include "tracking/tracked_rows.hpp"

namespace sysid {
namespace {

constexpr int rows_at_once = 1024, after_an_outlier = 32;  // what was simulated beyond an outlier is lost
/// The size of a jump is found on equations that are linearised as they were without it, and for the likeliest row: of 50 jumps by
/// a tenth the errors were 2.0 of the sds that this gives.
constexpr double beyond_linear = 2;
constexpr int most_lags = 1000;      // of a model that looks back
constexpr int most_in_a_row = 2;     // samples of a channel that are left out; more, one after the other, are a change
constexpr int most_until_lost = 16;  // of a filter that may begin again: until it is known what they are

}  // namespace

Tracker::Tracker(TrackedProgram program, SolverSettings solver, ExecutionOptions execution, TrackedPrior parameters,
                 StatePrior states, TrackingOptions options)
    : program_(std::move(program)),
      solver_(std::move(solver)),
      execution_(execution),
      prior_(std::move(parameters)),
      options_(std::move(options)),
      detector_(program_.states, program_.tracked, options_.false_alarms, options_.window),
      watch_(static_cast<int>(program_.channels.size()), options_.false_alarms, options_.window),
      factors_(program_.channels.size(), 1.0),
      explained_(program_.channels.size(), 0.0),
      runs_(program_.channels.size()),
      good_(prior_),
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
    if (!fresh_ && next_gap(experiment, from, from + 1) == from) begin_again(experiment, from, Restart::Cause::gap);
    from = take_some(experiment, from, next_gap(experiment, from + 1, std::min(rows, from + block)), sink);
  }
}

/// Up to what changes the filter; returns the row to go on with.
int Tracker::take_some(Experiment const& experiment, int from, int to, Sink const& sink) {
  int const first = fresh_ ? from : from - 1;
  Experiment part = slice(experiment, first, to, static_cast<int>(std::min<std::int64_t>(most_lags, row_of(experiment, first))));
  if (!fresh_) part.scored.front() = 0;  // it has corrected the moments
  if (left_out_row_ == row_of(experiment, from))
    for (std::size_t c = 0; c < part.measured.size(); ++c)
      if (row_.left_out[c] != 0) part.measured[c][static_cast<std::size_t>(from - first)] = std::nan("");
  LaneArray records;
  bool const fine = records_along(program_, solver_, execution_, part,
                                  parameters_of(program_, options_.intensities, moments_, factors_), records);
  if (!fine) {
    // Rows before it are known to be good.
    if (to - from == 1) {
      begin_again(experiment, from, Restart::Cause::divergence);
      return from;
    }
    int const half = from + (to - from) / 2;
    return take_some(experiment, from, half, sink);
  }
  for (int index = from; index < to; ++index) {
    double const* const row = records.view().data() + static_cast<std::ptrdiff_t>(index - first) * program_.records;
    Judged const judged = is_finite(row) ? judge(experiment, index, row) : Judged::lost;
    if (judged == Judged::lost) begin_again(experiment, index, is_finite(row) ? Restart::Cause::jump : Restart::Cause::divergence);
    if (judged != Judged::used) return index;
    if (read(experiment, index, row, sink)) return index + 1;
  }
  return to;
}

/// Samples that are to be left out: the row is then filtered once more, without them. A change of a parameter as large as that is
/// found later. Where a channel stays far off and smoothly so, the states are lost.
Tracker::Judged Tracker::judge(Experiment const& experiment, int index, double const* records) {
  std::int64_t const row = row_of(experiment, index);
  if (left_out_row_ == row) return Judged::used;  // without them it still comes here
  std::ranges::fill(row_.left_out, 0);
  if (!options_.leaves_out || settling_ > 0) return Judged::used;
  bool any = false, lost = false;
  bool const may = may_begin_again();
  for (std::size_t c = 0; c < program_.channels.size(); ++c) {
    auto const& channel = program_.channels[c];
    double const innovation = records[channel.innovation], variance = records[channel.variance];
    if (std::isnan(innovation) || !(variance > 0)) continue;
    double const sds = innovation / std::sqrt(variance);
    runs_[c].add(sds);
    lost = lost || (may && runs_[c].is_smooth());
    if (std::fabs(sds) <= FarOffRun::far_off) {
      left_out_in_a_row_[c] = 0;
    } else if (left_out_in_a_row_[c] < (may ? most_until_lost : most_in_a_row)) {
      ++left_out_in_a_row_[c];
      row_.left_out[c] = sds;
      any = true;
    }
  }
  if (lost) return Judged::lost;
  if (!any) return Judged::used;
  block_ = after_an_outlier;
  left_out_row_ = row;
  return Judged::left_out;
}

/// What the samples of a row say of changes; those that were left out count for the noise.
void Tracker::observe(double const* records) {
  for (std::size_t c = 0; c < program_.channels.size(); ++c) {
    auto const& channel = program_.channels[c];
    double const innovation = records[channel.innovation], variance = records[channel.variance];
    if (std::isnan(innovation)) {
      if (row_.left_out[c] != 0) watch_.observe(static_cast<int>(c), row_.left_out[c], explained_[c]);
      continue;
    }
    detector_.observe({innovation, variance, records + channel.slopes, records + channel.gains});
    double explained = 0;
    for (int k = 0; k < program_.size(); ++k) explained += records[channel.slopes + k] * records[channel.gains + k];
    explained_[c] = std::clamp(explained, 0.0, 0.999);
    watch_.observe(static_cast<int>(c), innovation / std::sqrt(variance), explained_[c]);
  }
}

/// True where the moments are no longer those of the records.
bool Tracker::read(Experiment const& experiment, int index, double const* records, Sink const& sink) {
  if (rows_ > 0) detector_.move(records + program_.transition);
  observe(records);
  std::copy_n(records + program_.after, program_.moments, moments_.begin());
  ++rows_;
  fresh_ = false;
  bool changed = false;
  bool const settling = settling_ > 0;
  std::optional<Alarm> alarm;
  std::optional<NoiseAlarm> noise;
  if (settling) {
    if (--settling_ == 0) alarm = end_settling(experiment, index), changed = true;
  } else if (auto const jump = detector_.detect()) {
    alarm = respond(experiment, index, *jump);
    changed = true;
  } else {
    noise = respond_to_noise(experiment, index);
    changed = noise.has_value();
  }
  report(experiment, index, records, row_);
  row_.settling = settling;
  row_.alarm = alarm ? &*alarm : nullptr;
  row_.noise = noise ? &*noise : nullptr;
  row_.restart = restart_ ? &*restart_ : nullptr;
  TrackedPrior const parameters = settling_ > 0 ? prior_ : parameters_now();
  scratch_.clear();
  for (int j = 0; j < program_.tracked; ++j) scratch_.push_back(parameters.covariance(j, j));
  detector_.keep(rows_, {parameters.mean.data(), static_cast<std::size_t>(program_.tracked)}, scratch_);
  times_.emplace_back(row_of(experiment, index), experiment.time[static_cast<std::size_t>(index)]);
  if (times_.size() > 4 * static_cast<std::size_t>(options_.window))
    times_.erase(times_.begin(), times_.end() - options_.window - 1);
  if (settling_ == 0) {
    watch_.keep(rows_);
    keep_good(records);
  }
  if (index > 0)
    last_step_ = experiment.time[static_cast<std::size_t>(index)] - experiment.time[static_cast<std::size_t>(index - 1)];
  sink(row_);
  restart_.reset();
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
  if (n == 0 || p == 0) return detector_.forget();
  Eigen::MatrixXd whole(n + p, n + p);
  for (int i = 0; i < n + p; ++i)
    for (int j = 0; j < n + p; ++j) whole(i, j) = program_.place(i, j) < 0 ? 0 : moment(i, j);
  Eigen::MatrixXd const cross = whole.topRightCorner(n, p);
  Eigen::MatrixXd const gain = cross * inverse(whole.bottomRightCorner(p, p));
  Eigen::VectorXd const shift = prior_.mean - Eigen::Map<Eigen::VectorXd const>(moments_.data() + n, p);
  Eigen::VectorXd const mean = Eigen::Map<Eigen::VectorXd const>(moments_.data(), n) + gain * shift;
  Eigen::MatrixXd const covariance =
      whole.topLeftCorner(n, n) - gain * cross.transpose() + gain * prior_.covariance * gain.transpose();
  std::vector<double> by_rows;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < p; ++j) by_rows.push_back(gain(i, j));
  detector_.set_back(by_rows);
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
  alarm.onset_row = row_after(jump.row);
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
  good_ = parameters_now();
  forget();
  return alarm;
}

}  // namespace sysid
