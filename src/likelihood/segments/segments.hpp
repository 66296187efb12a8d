// A record in segments that each start afresh, and what a model simulates over them: multiple shooting without continuity, whose
// start states are unknowns of their own (Bock 1983; van Domselaar, Hemker 1975).
#pragma once
#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "data/experiment.hpp"
#include "likelihood/compiled_model.hpp"
#include "likelihood/segments/carried_errors.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// Rows [first, first + count) of an experiment.
struct Segment {
  int experiment = 0, first = 0, count = 0;
  friend bool operator==(Segment const&, Segment const&) = default;
};

/// How often a record of `rows` may be halved so that no part has fewer than `least` rows.
int halvings(int rows, int least);
/// Each experiment in 2^h equal parts (to a row), h = halvings(its rows, least) but at most `most`. Parts of fewer halvings are
/// unions of those of more, and begin where these begin.
std::vector<Segment> cut_into_segments(std::span<Experiment const> experiments, int least, int most);

/// Where a simulation in segments stands: coefficients [k] and start states [states x segments], SI.
struct ShootingPoint {
  Eigen::VectorXd coefficients;
  Eigen::MatrixXd starts;
};

/// The simulations of a model that record the centre of each channel and nothing else.
std::shared_ptr<SimulationProgram const> compile_centres(CompiledModel const& compiled);
/// The same of each state, as if a channel measured it.
std::shared_ptr<SimulationProgram const> compile_states(CompiledModel const& compiled);

/// A segment at a point. Rows are channel by channel, in each sample by sample; 0 where nothing is measured. All are made
/// independent of each other where inputs carry errors, and divided by the relative noise of their sample.
struct SegmentSlopes {
  Eigen::VectorXd residual;        // simulated - measured
  Eigen::MatrixXd by_coefficient;  // [rows x k]: change by the perturbation of each coefficient
  Eigen::MatrixXd by_start;        // [rows x states]
  bool finite() const { return residual.allFinite(); }
};

/// What is known of the noise of a record before its size.
struct NoiseShape {
  /// [experiments][channels][rows]: noise of a sample in relation to the others of its channel; empty: all alike.
  std::vector<std::vector<std::vector<double>>> relative;
  /// Per channel, SI: the sd is at least this (digits of the file, error of the integrator); empty: 0.
  std::vector<double> floor;
  /// Per experiment; null: samples are independent. Else `relative` is not read: rows are made independent, and their sds are in
  /// relation to the floor, which is set.
  std::shared_ptr<std::vector<CarriedErrors> const> carried;
};

class SegmentSimulation {
 public:
  struct Settings {
    std::vector<int> fitted;     // parameters of the model that are the coefficients
    std::vector<double> others;  // all parameters of the model, SI; what is fitted is not read
    int counted = 0;             // only the first so many rows of each segment count; 0: all
    SolverSettings solver;
    ExecutionOptions execution;
    std::shared_ptr<ThreadPool> pool;
    /// Of `compile_centres`, or of `compile_states` with experiments that have a column for each state; null: the first.
    std::shared_ptr<SimulationProgram const> centres;
    NoiseShape noise = {};  // with the channels of the model
    int inner = 0;          // the last so many of `fitted` are parameters inside terms
  };
  /// compiled: with a free start. Segments have two rows or more.
  SegmentSimulation(std::shared_ptr<CompiledModel const> compiled, std::span<Experiment const> experiments,
                    std::vector<Segment> segments, Settings settings);

  std::vector<Segment> const& segments() const { return segments_; }
  int coefficients() const { return static_cast<int>(settings_.fitted.size()); }
  /// Of these the last ones that stand inside terms.
  int others() const { return settings_.inner; }
  int states() const { return static_cast<int>(compiled_->model.states.size()); }
  int channels() const { return settings_.centres->registers.records; }
  /// Measured samples that count: of a channel; of a segment.
  int samples_of_channel(int channel) const { return per_channel_[static_cast<std::size_t>(channel)]; }
  int samples_of_segment(int segment) const { return per_segment_[static_cast<std::size_t>(segment)]; }
  /// sd about its mean of all that a channel measures in the experiments; 1 where it does not move.
  double size(int channel) const { return size_[static_cast<std::size_t>(channel)]; }
  /// Sum of the logarithms of the relative noise of a channel's samples.
  double log_relative(int channel) const { return log_relative_[static_cast<std::size_t>(channel)]; }
  /// The least noise sd of a channel: as stated, and at least 1e-9 of its size.
  double least_noise(int channel) const;
  /// Whether outputs are smooth functions of the point to the last digits: of fixed steps.
  bool smooth() const { return settings_.solver.fixed_step(); }
  /// Whether a row of a segment's slopes is measured.
  bool measured(int segment, int row) const;
  /// Changes of what is simulated, in rows of slopes, as slopes have them: independent rows over their relative noise. In place.
  void in_relative_noise(int segment, Eigen::Ref<Eigen::MatrixXd> columns) const;
  /// Rows of a segment's slopes that belong to one channel.
  int rows_of_channel(int segment) const { return counted_rows(segment); }

  /// All segments with all perturbations in one batch: coefficient j by step(j), state s of segment i by start_step(s, i).
  std::vector<SegmentSlopes> slopes(ShootingPoint const& at, Eigen::VectorXd const& step, Eigen::MatrixXd const& start_step) const;
  /// Residuals alone.
  std::vector<SegmentSlopes> residuals(ShootingPoint const& at) const;

 private:
  void whiten();
  int counted_rows(int segment) const;
  std::vector<SegmentSlopes> run(ShootingPoint const& at, Eigen::VectorXd const* step, Eigen::MatrixXd const* start_step) const;

  std::shared_ptr<CompiledModel const> compiled_;
  std::vector<Segment> segments_;
  Settings settings_;
  std::vector<Simulator> simulators_;
  std::vector<std::vector<double>> samples_;  // [segments][rows of slopes]; NaN: nothing measured
  std::vector<std::vector<double>> weights_;  // the same rows: 1 / relative noise; empty: all 1
  std::vector<RowWhitener> whiteners_;        // [segments]; empty: rows are independent
  std::vector<double> log_relative_;          // per channel
  std::vector<int> per_channel_, per_segment_;
  std::vector<double> size_;
};

}  // namespace sysid
