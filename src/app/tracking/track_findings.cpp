// Sentences of changes, restarts and innovations.
#include "app/tracking/track_findings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/text/number.hpp"
#include "core/text/words.hpp"

namespace sysid {
namespace {

std::string changed(double before, double after) {
  if (before == 0 || (before > 0) != (after > 0)) return "changed";
  return fmt::format("{} by {} %", std::fabs(after) < std::fabs(before) ? "fell" : "rose",
                     significant(100 * std::fabs(after / before - 1), 2));
}

}  // namespace

std::string change_words(GatheredTrack const& gathered, Alarm const& alarm) {
  std::size_t const q = gathered.states + static_cast<std::size_t>(alarm.parameter);
  double const scale = gathered.units.scales[q];
  return fmt::format("`{}` {} after row {}, from {} to {}{}", gathered.units.names[q], changed(alarm.before, alarm.after),
                     alarm.onset_row, with_sd(alarm.before / scale, alarm.before_sd / scale),
                     with_sd(alarm.after / scale, alarm.after_sd / scale), unit_after_number(gathered.units.units[q]));
}

std::string noise_words(GatheredTrack const& gathered, NoiseAlarm const& alarm) {
  std::string const what = alarm.correlated     ? "the size of the innovations, which are correlated,"
                           : gathered.disturbed ? "the noise or a disturbance"
                                                : "the noise";
  return fmt::format("{} of `{}` {} to {} times its sd before ({} times that of the fit) after row {}", what,
                     gathered.channels[static_cast<std::size_t>(alarm.channel)], alarm.ratio < 1 ? "fell" : "rose",
                     significant(alarm.ratio, 2), significant(alarm.now, 2), alarm.onset_row);
}

std::string restart_words(Restart const& restart) {
  switch (restart.cause) {
    case Restart::Cause::gap:
      return fmt::format("{} s after the previous row: a gap in time, after which the states are estimated again",
                         significant(restart.step, 3));
    case Restart::Cause::jump:
      return "the samples stay far from the predictions: from this row on the states and parameters are estimated again";
    case Restart::Cause::divergence:
      return "the filter has no finite values: from this row on the states and parameters are estimated again";
  }
  return "";
}

InnovationSize innovation_size(GatheredTrack const& gathered) {
  auto const n = static_cast<double>(gathered.samples);
  if (n == 0) return {1, 0};
  return {std::sqrt(gathered.squared / n), (gathered.squared - n) / std::sqrt(2 * n)};
}

namespace {

/// "3 samples far from the predictions were left out: d at row 450 (101 expected sds off), ...".
Finding far_off_samples(GatheredTrack const& gathered) {
  constexpr std::size_t most_told = 3;
  constexpr double many = 0.01;
  std::vector<std::string> told, names;
  for (GatheredTrack::LeftOut const& each : gathered.left_out) {
    if (told.size() < most_told)
      told.push_back(
          fmt::format("{} at row {} ({} expected sds off)", each.channel, each.row, significant(std::fabs(each.sds), 2)));
    if (std::find(names.begin(), names.end(), each.channel) == names.end()) names.push_back(each.channel);
  }
  auto const more = gathered.left_out_samples - static_cast<std::int64_t>(told.size());
  return {FindingCode::samples_far_off, Severity::warning, std::move(names),
          fmt::format("{} far from the predictions {} left out: {}{}", counted(gathered.left_out_samples, "sample"),
                      gathered.left_out_samples == 1 ? "was" : "were", fmt::join(told, ", "),
                      more > 0 ? fmt::format(" and {} more", more) : ""),
          static_cast<double>(gathered.left_out_samples) > many * static_cast<double>(gathered.samples)
              ? "these are too many for single outliers: check the sensor, the units of the record, and whether the model and its "
                "noise are right for these rows"
              : "check the sensor at these rows"};
}

/// Changes of several parameters within a few rows, or of one and back again: a fault of a sensor has the same effect.
bool may_be_a_sensor(GatheredTrack const& gathered) {
  constexpr std::int64_t together = 500;
  for (std::size_t i = 1; i < gathered.alarms.size(); ++i) {
    Alarm const &one = gathered.alarms[i - 1], &next = gathered.alarms[i];
    bool const back = (one.after > one.before) != (next.after > next.before);
    if ((one.parameter != next.parameter || back) && next.onset_row - one.onset_row <= together) return true;
  }
  return false;
}

constexpr std::size_t most_told_changes = 3;

Finding changed_parameters(GatheredTrack const& gathered) {
  std::size_t const changes = gathered.alarms.size();
  std::vector<std::string> told, names;
  for (std::size_t i = 0; i < std::min(changes, most_told_changes); ++i) told.push_back(change_words(gathered, gathered.alarms[i]));
  for (Alarm const& each : gathered.alarms) {
    std::string const& name = gathered.units.names[gathered.states + static_cast<std::size_t>(each.parameter)];
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return {FindingCode::parameter_changed, Severity::warning, std::move(names),
          fmt::format("{}{}", fmt::join(told, "; "),
                      changes > most_told_changes ? fmt::format("; and {} more", changes - most_told_changes) : ""),
          may_be_a_sensor(gathered)
              ? "several parameters changed within a few rows, or one changed and then changed back, as a fault of a sensor also "
                "makes them: first check these rows for a change of the sensor's gain or sign, an offset, and lost rows; only then "
                "look for a cause in the structure"
              : "look for the cause at these rows; to predict later rows, fit the rows after the last change and use that fit"};
}

Finding changed_noise(GatheredTrack const& gathered) {
  std::vector<std::string> told, names;
  bool correlated = false;
  for (NoiseAlarm const& each : gathered.noises) {
    correlated = correlated || each.correlated;
    if (told.size() < most_told_changes) told.push_back(noise_words(gathered, each));
    std::string const& name = gathered.channels[static_cast<std::size_t>(each.channel)];
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  std::size_t const more = gathered.noises.size() - told.size();
  return {
      FindingCode::noise_changed, Severity::warning, std::move(names),
      fmt::format("{}{}", fmt::join(told, "; "), more > 0 ? fmt::format("; and {} more", more) : ""),
      correlated
          ? "noise of a sensor does not explain correlated innovations: check the sensor for a change of its gain, an offset, or "
            "lost rows, and the model for an unmeasured force or a parameter that is not tracked"
          : "check the sensor at these rows; after them the filter uses the new noise of the channel"};
}

/// "at row 8012 (the samples stayed far from the predictions) and 3 more".
Finding lost_states(GatheredTrack const& gathered) {
  std::vector<std::string> told;
  for (Restart const& each : gathered.restarts) {
    if (told.size() == most_told_changes) break;
    told.push_back(fmt::format(
        "at row {} ({})", each.row,
        each.cause == Restart::Cause::jump ? "the samples stayed far from the predictions" : "it had no finite values"));
  }
  auto const more = gathered.all_restarts - static_cast<std::int64_t>(told.size());
  return {FindingCode::filter_restarted,
          Severity::warning,
          {},
          fmt::format("the filter began again {}{}", fmt::join(told, ", "), more > 0 ? fmt::format(" and {} more", more) : ""),
          "check the record there for lost rows, a jump of its time, and a change of a unit or a sign; if the record is right, the "
          "structure has changed considerably: fit the rows after the restart"};
}

Finding gaps_in_time(GatheredTrack const& gathered) {
  Restart const& longest = *std::ranges::max_element(gathered.gaps, {}, &Restart::step);
  std::string const others = gathered.all_gaps > 1 ? fmt::format(" (and {} more)", gathered.all_gaps - 1) : "";
  return {FindingCode::time_gap,
          Severity::warning,
          {},
          fmt::format("the time has a gap of {} s before row {}{}; the usual step is {} s", significant(longest.step, 3),
                      longest.row, others, significant(gathered.usual_step, 3)),
          "the input during the gap is unknown, so the states are estimated again after it; check whether rows were lost there"};
}

}  // namespace

void add_findings(GatheredTrack const& gathered, Report& report) {
  InnovationSize const size = innovation_size(gathered);
  report.verdict = fmt::format("no change found in {} rows", gathered.rows);
  if (std::size_t const changes = gathered.alarms.size(); changes > 0) {
    report.verdict = fmt::format("{} found in {} rows", counted(changes, "change"), gathered.rows);
    report.findings.push_back(changed_parameters(gathered));
  } else if (gathered.changed()) {
    report.verdict = fmt::format("no change of a parameter found in {} rows", gathered.rows);
  }
  if (!gathered.noises.empty()) {
    report.findings.push_back(changed_noise(gathered));
    report.verdict += fmt::format("; the noise of {} changed",
                                  quoted({report.findings.back().names.begin(), report.findings.back().names.end()}));
  }
  if (gathered.all_restarts > 0) {
    report.verdict += fmt::format("; {} of the filter", counted(gathered.all_restarts, "restart"));
    report.findings.push_back(lost_states(gathered));
  }
  if (gathered.all_gaps > 0) {
    report.verdict += fmt::format("; {} in time", counted(gathered.all_gaps, "gap"));
    report.findings.push_back(gaps_in_time(gathered));
  }
  if (gathered.left_out_samples > 0) {
    report.verdict += fmt::format("; {} left out", counted(gathered.left_out_samples, "sample"));
    report.findings.push_back(far_off_samples(gathered));
  }
  if (!size.odd()) return;
  report.verdict += fmt::format("; the innovations are {} than expected", size.ratio > 1 ? "larger" : "smaller");
  report.findings.push_back(
      {FindingCode::innovation_size,
       Severity::warning,
       {},
       fmt::format("the rms of the innovations is {} times what is expected (z = {:.1f}): sds and the rate of false alarms are not "
                   "as stated",
                   significant(size.ratio, 4), size.z),
       "add a disturbance to the model, or fit its noise to rows like these"});
}

}  // namespace sysid
