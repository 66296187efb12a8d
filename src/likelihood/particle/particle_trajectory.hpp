// Particles along a record: predictions of each sample from those before it, and states given all samples.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "likelihood/particle/particle_filter.hpp"
#include "likelihood/smoothing/smoother.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// The innovations of a record: with the parameters of the truth, independent standard normal numbers.
struct ParticleInnovations {
  /// [channels][samples] z of P(Y <= y | samples before it, and of earlier channels) = Phi(z); NaN where not scored. Of noise that
  /// is not normal |z| ends where one particle in two would be beyond.
  std::vector<std::vector<double>> standardised;
  /// [channels][samples] the mean of the location, declared units.
  std::vector<std::vector<double>> predicted;
  FilterOutcome outcome;
};

class ParticleTrajectory {
 public:
  /// model: particle_model of `written`, for the method of `solver`. The rows of the experiment that correct states are those that
  /// it names, else those that are scored.
  ParticleTrajectory(std::shared_ptr<ParticleModel const> model, Model const& written, Experiment const& experiment,
                     SolverSettings const& solver, int particles, ExecutionOptions const& options);
  ~ParticleTrajectory();

  int samples() const { return densities_.schedule().samples(); }
  /// Of smoothed states: states, disturbances, derived quantities that read states.
  std::vector<SmoothedName> const& smoothed_quantities() const { return smoothed_names_; }

  struct Result {
    /// As that of a Trajectory: means, sds and draws of what particles predict for each sample. Bands of noise that is not normal
    /// are those of draws.
    Trajectory::Result predicted;
    /// smoothed[q][d * picks + k][i]: draw k of quantity q at sample i, for parameter vector d. Each sample by itself: bands are
    /// right, paths are not.
    std::vector<std::vector<std::vector<double>>> smoothed;
    int picks = 0;
  };
  /// parameters: of the model, SI [parameters x W]. Vector d has the numbers of (key, index d).
  /// ahead: each sample is predicted from those so many rows before it and earlier; it costs about that many times as much. Nothing
  /// is smoothed then.
  Result run(ConstLanes parameters, StreamKey key, bool smooth, int ahead = 1) const;
  /// parameters: [parameters x 1].
  ParticleInnovations innovations(ConstLanes parameters, StreamKey key) const;

 private:
  class Recorder;
  struct Path;
  struct Smoothed {
    enum class Kind { state, average, derived };
    Kind kind;
    int index;  // state, disturbance, record
  };
  Path path(ConstLanes parameters, StreamKey key, int picks, int ahead) const;
  void choose_shown();
  void collect(std::vector<Path>& paths, Result& result) const;
  Quantity const& quantity_of(CompiledModel::Record const& record) const;
  Quantity const& quantity_of(Smoothed const& shown) const;

  std::shared_ptr<ParticleModel const> model_;
  Model written_;
  std::shared_ptr<CompiledModel const> compiled_;  // of the particles' model: its trajectory program
  std::shared_ptr<ThreadPool> pool_;
  Simulator densities_, records_;
  int particles_;
  std::vector<int> shown_;                   // records, in the order of a Trajectory's quantities
  std::vector<std::vector<int>> arguments_;  // records, of the noise of each channel
  std::vector<Smoothed> smoothed_;
  std::vector<SmoothedName> smoothed_names_;
};

}  // namespace sysid
