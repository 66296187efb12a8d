// States and parameters along rows as they arrive: the filter of a TrackedProgram, its beginning, and alarms where a parameter has
// jumped.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "data/experiment.hpp"
#include "simulate/simulator.hpp"
#include "tracking/change_detector.hpp"
#include "tracking/noise_watch.hpp"
#include "tracking/tracked_program.hpp"

namespace sysid {

/// Of the parameters on their unbounded scales.
struct TrackedPrior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

/// Of the states at the first row.
struct StatePrior {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
  /// It is a guess: the first rows tell of the states alone, what they say of the parameters is left aside.
  bool settles = false;
};

struct TrackingOptions {
  std::vector<double> intensities;  // of the random walks [tracked]: of differential equations per second, of maps per row
  std::vector<double> scales;       // [tracked] a large change on the unbounded scale
  double false_alarms = 1e-5;       // most of them per row
  int window = 2048;                // rows looked back for a jump
  int settling_rows = 50;
  /// Samples too far from their prediction for any change of a parameter are left out. Not where predictions read measured samples:
  /// one that is left out would be missing in those of later rows.
  bool leaves_out = true;
  /// Somewhere along a record: where the states begin again. Absent: they never do, and a filter that diverges is a UserError.
  std::optional<StatePrior> anywhere = {};
  /// [s] The usual time between rows, where they follow each other at one step; else 0. Behind one that is longer, and longer than
  /// the one before, the states begin again.
  double usual_step = 0;
};

/// A jump of a parameter, in SI; rows as of the experiment's file.
struct Alarm {
  int parameter = 0;  // of the tracked ones
  std::int64_t row = 0, onset_row = 0;
  double time = 0;
  double statistic = 0;  // z
  double before = 0, before_sd = 0, after = 0, after_sd = 0;
  int other = -1;  // a parameter that explains it nearly as well
  double other_statistic = 0;
};

/// The noise of a channel has another size.
struct NoiseAlarm {
  int channel = 0;
  std::int64_t row = 0, onset_row = 0;
  double time = 0;
  double statistic = 0;
  double ratio = 1, now = 1;  // its sd, to that before and to that of the fit
  bool correlated = false;
};

/// The states were lost, and begin again.
struct Restart {
  enum class Cause : std::uint8_t { gap, jump, divergence };
  Cause cause = Cause::gap;
  std::int64_t row = 0;       // the first one again
  double time = 0, step = 0;  // step: to the row before
};

/// Estimates once the samples of a row are known, SI. Valid during the call it is handed to.
struct TrackedRow {
  std::int64_t row = 0;
  double time = 0;
  bool settling = false;
  std::vector<double> mean, sd;  // [states + tracked]
  std::size_t tracked = 0;
  std::vector<double> innovation, expected;  // per channel, and its sd; NaN: no sample
  double squared = 0;                        // sum of (innovation/sd)^2
  int samples = 0;
  std::vector<double> left_out;  // per channel, how many expected sds off a sample was that was left out; else 0
  Alarm const* alarm = nullptr;
  NoiseAlarm const* noise = nullptr;
  Restart const* restart = nullptr;  // before this row
};

class Tracker {
 public:
  using Sink = std::function<void(TrackedRow const&)>;

  Tracker(TrackedProgram program, SolverSettings solver, ExecutionOptions execution, TrackedPrior parameters, StatePrior states,
          TrackingOptions options);

  /// Rows from index `from` of the experiment on, in order; each goes to `sink`. From the second call on index from - 1 is the row
  /// that came last. rows_before: of the file, which the experiment does not count: more than it can, of a record without an end.
  /// Where the filter has no finite values it begins again; UserError where that helps nothing.
  void take(Experiment const& experiment, int from, Sink const& sink, std::int64_t rows_before = 0);

  ChangeDetector const& detector() const { return detector_; }

 private:
  int take_some(Experiment const& experiment, int from, int to, Sink const& sink);
  std::int64_t row_of(Experiment const& experiment, int index) const { return rows_before_ + experiment.first_row + index; }
  enum class Judged : std::uint8_t { used, left_out, lost };
  Judged judge(Experiment const& experiment, int index, double const* records);
  bool is_finite(double const* records) const;
  void observe(double const* records);
  bool read(Experiment const& experiment, int index, double const* records, Sink const& sink);
  void report(Experiment const& experiment, int index, double const* records, TrackedRow& row);
  void settle();
  std::optional<Alarm> end_settling(Experiment const& experiment, int index);
  std::optional<NoiseAlarm> respond_to_noise(Experiment const& experiment, int index);
  std::int64_t row_after(std::int64_t counted) const;
  TrackedPrior parameters_now() const;
  void keep_good(double const* records);
  void forget();

  // --- beginning again
  bool may_begin_again() const;
  void begin_again(Experiment const& experiment, int index, Restart::Cause cause);
  /// The first row from `from` up to `to` behind a gap in time, else `to`.
  int next_gap(Experiment const& experiment, int from, int to) const;
  Alarm respond(Experiment const& experiment, int index, DetectedJump const& jump);
  double& moment(int i, int j) { return moments_[static_cast<std::size_t>(program_.place(i, j))]; }
  double variance(int i) const { return moments_[static_cast<std::size_t>(program_.place(i, i))]; }
  /// SI value and sd of a tracked parameter whose coordinate has this mean and variance; the other parameters are where they are
  /// now.
  std::pair<double, double> value_of(int parameter, double mean, double variance) const;
  void values_now(std::vector<double>& mean, std::vector<double>& sd);

  TrackedProgram program_;
  SolverSettings solver_;
  ExecutionOptions execution_;
  TrackedPrior prior_;
  TrackingOptions options_;
  ChangeDetector detector_;
  NoiseWatch watch_;
  std::vector<double> factors_, explained_;  // per channel: of its noise variance; of its last sample, as NoiseWatch::observe
  std::vector<FarOffRun> runs_;              // per channel
  TrackedPrior good_;                        // of rows whose innovations were of the size expected
  double good_squared_ = 0, good_samples_ = 0;
  bool fresh_ = true, opened_ = false;  // the next row is the first of a filter; that also asks for the parameters anew
  std::int64_t begun_ = 0;              // rows taken when it began again
  std::optional<Restart> restart_;
  double last_step_ = 0;  // [s] between the rows that came last; 0: there was one
  std::vector<double> moments_;
  std::int64_t rows_ = 0, rows_before_ = 0;  // taken so far; as of take
  int settling_ = 0;                         // rows left
  std::int64_t left_out_row_ = 0;            // the row of the file that has samples left out, as row_.left_out says; 0: none yet
  std::vector<int> left_out_in_a_row_;       // per channel, of its samples before the next one
  int block_ = 32;                           // rows that are simulated at once
  std::vector<std::pair<std::int64_t, double>> times_;  // of the rows that a jump may have come after: row of the file, time
  TrackedRow row_;
  std::vector<double> scratch_;
};

}  // namespace sysid
