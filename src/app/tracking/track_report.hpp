// What is kept of the rows of a track for its page: some of them, all alarms, sums.
#pragma once
#include <string>
#include <vector>

#include "app/tracking/track_table.hpp"

namespace sysid {

/// "1.000 ± 0.004": as many digits of a value as its sd leaves room for.
std::string with_sd(double value, double sd);

struct GatheredTrack {
  GatheredTrack(TrackedFit const& fit, TrackedUnits units);
  void add(TrackedRow const& row);
  /// "row 3001 (t = 30.0 s): `k` fell from 1.000 ± 0.004 to 0.902 ± 0.009 N/m after row 2950 (z = -11.2)"
  std::string alarm_line(Alarm const& alarm) const;
  /// What there is to say of a row as it comes.
  std::vector<std::string> lines(TrackedRow const& row) const;
  /// Some parameter or noise has changed, or the filter was lost: a gap in time is neither.
  bool changed() const;
  /// "k [N/m]", of a state or a tracked parameter.
  std::string name(std::size_t quantity) const;

  TrackedUnits units;
  std::vector<std::string> channels;
  std::size_t states, tracked;
  std::string file, digest;
  std::optional<Unit> time_unit;
  double threshold = 0;
  std::int64_t rows = 0, samples = 0;
  std::int64_t first_row = 0, last_row = 0;
  double squared = 0;  // of the rows that did not settle
  std::vector<Alarm> alarms;
  std::vector<NoiseAlarm> noises;
  std::vector<Restart> gaps, restarts;  // the first hundred of each
  std::int64_t all_gaps = 0, all_restarts = 0;
  bool disturbed = false;  // the model has disturbances
  double usual_step = 0;
  struct LeftOut {
    std::int64_t row;
    std::string channel;
    double sds;
  };
  std::vector<LeftOut> left_out;  // samples too far from their prediction, the first hundred
  std::int64_t left_out_samples = 0;
  std::vector<double> first_mean, first_sd, last_mean, last_sd;  // [states + tracked], declared units
  bool settled = false;        // some rows settled the states: then the parameters begin behind them, as the fit has them
  bool past_settling = false;  // and there are rows behind them
  // Every `stride`th row, of those that did not settle where there are any.
  std::vector<double> time;
  std::vector<std::vector<double>> mean, sd;  // [states + tracked][rows]
  std::int64_t stride = 1, kept = 0;
};

Report track_head(Session const& session, TrackedFit const& fit);
void fill_report(Session const& session, TrackedFit const& fit, GatheredTrack const& gathered, Report& report);

}  // namespace sysid
