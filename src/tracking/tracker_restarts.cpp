// A filter that has lost its states, or whose noise has changed: what it goes on with.
#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "tracking/tracked_rows.hpp"
#include "tracking/tracker.hpp"

namespace sysid {
namespace {

constexpr double opening = 0.3;             // of a large change of a parameter: the sd that is added where the states were lost
constexpr double longer = 1.5;              // than the usual step is a gap
constexpr double looked_at = 64, calm = 2;  // samples; their mean square, in expected variances
constexpr double most_noise = 1e6;          // of the variance of the fit's
constexpr int settled_again = 3;            // lengths of the settling rows: a filter that begins again has seen as many

}  // namespace

std::int64_t Tracker::row_after(std::int64_t counted) const {
  // times_ ends with the row before this one, which is the rows_ - 1st.
  if (times_.empty()) return row_.row;
  auto const back = static_cast<std::size_t>(rows_ - 1 - counted);
  return times_[times_.size() - 1 - std::min(back, times_.size() - 1)].first;
}

TrackedPrior Tracker::parameters_now() const {
  int const p = program_.tracked;
  TrackedPrior now{Eigen::Map<Eigen::VectorXd const>(moments_.data() + program_.states, p), Eigen::MatrixXd::Zero(p, p)};
  for (int i = 0; i < p; ++i)
    for (int j = 0; j < p; ++j)
      if (int const place = program_.place(program_.states + i, program_.states + j); place >= 0)
        now.covariance(i, j) = moments_[static_cast<std::size_t>(place)];
  return now;
}

bool Tracker::is_finite(double const* records) const {
  return std::ranges::all_of(program_.channels, [&](TrackedProgram::Channel const& channel) {
    return std::isnan(records[channel.innovation]) || records[channel.variance] > 0;
  });
}

/// The parameters are remembered while innovations are of the size expected.
void Tracker::keep_good(double const* records) {
  for (auto const& channel : program_.channels) {
    double const innovation = records[channel.innovation];
    if (std::isnan(innovation)) continue;
    good_squared_ += innovation * innovation / records[channel.variance];
    good_samples_ += 1;
  }
  if (good_samples_ < looked_at) return;
  if (good_squared_ < calm * good_samples_) good_ = parameters_now();
  good_squared_ = good_samples_ = 0;
}

/// Where the filter has been changed, what rows before said of it no longer counts.
void Tracker::forget() {
  detector_.forget();
  watch_.forget();
  good_squared_ = good_samples_ = 0;
  std::ranges::fill(left_out_in_a_row_, 0);
  for (FarOffRun& each : runs_) each.clear();
}

bool Tracker::may_begin_again() const {
  return options_.anywhere && program_.states > 0 && rows_ - begun_ > settled_again * options_.settling_rows;
}

int Tracker::next_gap(Experiment const& experiment, int from, int to) const {
  bool const looks = options_.anywhere && options_.usual_step > 0 && program_.states > 0;
  if (!looks) return to;
  for (int i = std::max(1, from); i < to; ++i) {
    auto const at = static_cast<std::size_t>(i);
    double const step = experiment.time[at] - experiment.time[at - 1];
    double const before = i > 1 ? experiment.time[at - 1] - experiment.time[at - 2] : last_step_;
    if (before > 0 && step > longer * std::max(before, options_.usual_step)) return i;
  }
  return to;
}

/// From anywhere, so that the next rows settle the states. Behind a gap in time the parameters are what they were. Else they are
/// those of the last rows that were well predicted, and asked for anew beside the states: what looks like lost rows may be a
/// change.
void Tracker::begin_again(Experiment const& experiment, int index, Restart::Cause cause) {
  if (!options_.anywhere || fresh_) throw diverged(experiment, row_of(experiment, index));
  auto const at = static_cast<std::size_t>(index);
  restart_ =
      Restart{cause, row_of(experiment, index), experiment.time[at], index > 0 ? experiment.time[at] - experiment.time[at - 1] : 0};
  prior_ = cause == Restart::Cause::gap && settling_ == 0 ? parameters_now() : cause == Restart::Cause::gap ? prior_ : good_;
  opened_ = opened_ || cause != Restart::Cause::gap;
  TrackedPrior start = prior_;
  for (int j = 0; opened_ && j < program_.tracked; ++j)
    start.covariance(j, j) += std::pow(opening * options_.scales[static_cast<std::size_t>(j)], 2);
  moments_ = moments_of(program_, *options_.anywhere, start);
  settling_ = program_.states > 0 ? (opened_ ? 2 : 1) * options_.settling_rows : 0;
  fresh_ = true;
  begun_ = rows_;
  block_ = 32;
  left_out_row_ = 0;
  forget();
  std::ranges::fill(row_.left_out, 0);
}

/// What the rows say of parameters that were asked for anew is kept where it contradicts what they were.
std::optional<Alarm> Tracker::end_settling(Experiment const& experiment, int index) {
  int changed = -1, other = -1;
  double z = 0, other_z = 0;
  TrackedPrior const now = parameters_now();
  for (int j = 0; opened_ && j < program_.tracked; ++j) {
    double const each = (now.mean(j) - prior_.mean(j)) / std::sqrt(now.covariance(j, j) + prior_.covariance(j, j));
    if (std::fabs(each) > std::fabs(z))
      other = std::exchange(changed, j), other_z = std::exchange(z, each);
    else if (std::fabs(each) > std::fabs(other_z))
      other = j, other_z = each;
  }
  bool const differs = opened_ && std::fabs(z) > detector_.threshold();
  opened_ = false;
  if (!differs) {
    settle();
    return std::nullopt;
  }
  Alarm alarm;
  alarm.parameter = changed;
  alarm.row = row_of(experiment, index);
  alarm.time = experiment.time[static_cast<std::size_t>(index)];
  alarm.onset_row = row_after(begun_);
  alarm.statistic = z;
  alarm.other = other;
  alarm.other_statistic = other_z;
  std::tie(alarm.before, alarm.before_sd) = value_of(changed, prior_.mean(changed), prior_.covariance(changed, changed));
  std::tie(alarm.after, alarm.after_sd) = value_of(changed, now.mean(changed), now.covariance(changed, changed));
  good_ = now;
  forget();
  return alarm;
}

/// The filter weighs the channel by its new noise from here on.
std::optional<NoiseAlarm> Tracker::respond_to_noise(Experiment const& experiment, int index) {
  if (std::ranges::any_of(runs_, [](FarOffRun const& each) { return each.is_open(); })) return std::nullopt;
  auto const change = watch_.detect(detector_.explained());
  if (!change) return std::nullopt;
  double& factor = factors_[static_cast<std::size_t>(change->channel)];
  double const before = factor;
  factor = std::clamp(factor * change->factor, 1 / most_noise, most_noise);
  if (factor == before) return std::nullopt;
  NoiseAlarm alarm{
      change->channel,   row_of(experiment, index),  row_after(change->row), experiment.time[static_cast<std::size_t>(index)],
      change->statistic, std::sqrt(factor / before), std::sqrt(factor),      change->correlated};
  forget();
  return alarm;
}

}  // namespace sysid
