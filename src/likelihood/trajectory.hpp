// The trajectory view: what given parameter vectors predict along a record, for bands, scores and made data.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "core/numeric/random.hpp"
#include "likelihood/compiled_model.hpp"
#include "likelihood/failures.hpp"
#include "likelihood/start_state.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// A channel's location without noise, a state, or a derived quantity; declared units.
struct TrajectoryQuantity {
  std::string name, unit;
  int channel = -1;  // of the model; -1: not measured
};

/// For simulations of which nothing is summed: where states are random, the rows that correct them take the place of those that are
/// scored.
Experiment with_corrections(Model const& model, Experiment experiment);

class Trajectory {
 public:
  /// start_rows > 0: the compiled model has a free start, fitted to the experiment's first rows. describe: places of failures in
  /// the user's words; empty for "the model".
  Trajectory(std::shared_ptr<CompiledModel const> compiled, Experiment const& experiment, SolverSettings const& solver,
             int start_rows, ExecutionOptions options, Describe describe = {});

  std::vector<TrajectoryQuantity> const& quantities() const { return quantities_; }
  int samples() const { return simulator_.schedule().samples(); }

  /// values[q][d][i]: quantity q of parameter vector d at sample i; noisy[c][d][i]: channel c with one draw of its noise added,
  /// from the stream of (noise_key, index d, step c). A failed vector is NaN throughout.
  struct Result {
    std::vector<std::vector<std::vector<double>>> values, noisy;
    /// Where states are random given the parameters, `values` are their means, spread[q][d][i] their sds, and random[q] draws about
    /// them, each sample by itself: bands of one sample are right, paths along several are not. Empty for quantities that are
    /// known. noisy_spread[c]: sds of the samples of a channel about `values`, that of the noise included; empty as above.
    std::vector<std::vector<std::vector<double>>> random, spread, noisy_spread;
    bool is_random(std::size_t q) const { return q < random.size() && !random[q].empty(); }
    /// Draws of a quantity: `random` where states are, else `values`.
    std::vector<std::vector<double>> const& drawn(std::size_t q) const { return is_random(q) ? random[q] : values[q]; }
    std::vector<std::vector<double>>& drawn(std::size_t q) { return is_random(q) ? random[q] : values[q]; }
    /// solved[d]: 1, vector d did not fail, whether or not it is defined everywhere.
    std::vector<char> solved;
    /// Of all vectors; what failed has its place there.
    Ledger ledger;
    int failed() const { return static_cast<int>(ledger.failed()); }
    /// noise_mean[c][d][i], noise_variance: moments of the noise of channel c, declared units; NaN where it has none. Only when
    /// asked for.
    std::vector<std::vector<std::vector<double>>> noise_mean, noise_variance;
    /// drift[k][d]: largest violation of invariant k of the model along vector d, as a part of the largest size of its terms.
    std::vector<std::vector<double>> drift;
  };
  /// parameters: of the model, SI [parameters x W]; NaN where irrelevant. moments: of the noise, too. ahead: of random states; each
  /// sample is predicted from those that lie so many rows before it or more. 1, as 0: from all that correct the states before it.
  /// noises: draws of the noise about each vector, of few vectors; noisy[c][k W + d] is the k-th about vector d.
  Result run(ConstLanes parameters, StreamKey noise_key, bool moments = false, int ahead = 0, int noises = 1) const;
  /// Arguments of a channel's noise along the record, SI: [samples][arguments]; NaN where the solve fails. parameters: [parameters
  /// x 1].
  std::vector<std::vector<double>> noise_arguments(ConstLanes parameters, int channel) const;
  /// The tutorial's Fig. 8.4: at every sample trajectory d continues with a posterior draw picked afresh by the stream of
  /// (redraw_key, index d, step sample). parameters: [parameters x draws]; trajectories: how many.
  Result run_redrawn(ConstLanes parameters, int trajectories, StreamKey redraw_key, StreamKey noise_key) const;

 private:
  /// For what is recorded of so many vectors; UserError (E5003) where it is too much.
  LaneArray no_records(int width) const;
  void record_failures(LaneArray const& parameters, std::vector<Outcome> const& outcome, Ledger& ledger) const;
  void collect(LaneArray const& records, std::vector<Outcome> const& outcome, int first, StreamKey noise_key, int noises,
               Result& result) const;
  void collect_moments(LaneArray const& records, std::vector<Outcome> const& outcome, Result& result) const;
  void add_noisy_spreads(LaneArray const& records, std::vector<Outcome> const& outcome, int row, Result& result) const;
  void add_spread(ConstLanes records, int lane, int spread, StreamKey key, std::vector<double>& values) const;
  std::vector<std::vector<double>> with_noise(LaneArray const& records, std::vector<Outcome> const& outcome, int row,
                                              StreamKey key) const;

  std::shared_ptr<CompiledModel const> compiled_;
  Simulator simulator_;
  std::unique_ptr<StartState> start_;
  Describe describe_;
  std::vector<TrajectoryQuantity> quantities_;
  std::vector<int> spreads_;  // per record the one that is its sd, -1: none
};

}  // namespace sysid
