// The Target of a model with random states whose likelihood is estimated by particles: for kinks, noise that is not normal, large
// disturbances.
#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "likelihood/model_target.hpp"
#include "likelihood/parameter_space.hpp"
#include "likelihood/particle/particle_filter.hpp"
#include "likelihood/target.hpp"

namespace sysid {

/// Particles of a filter where nothing else is asked for.
constexpr int default_particles = 512;

/// Which random numbers `log_likelihood` takes.
enum class ParticleNumbers {
  fixed,          // the same for all parameter vectors, so that neighbours can be compared: for searches
  of_parameters,  // each parameter vector its own, as independent of those of any other as fresh ones, but the same whenever it is
                  // asked for: for chains, which then sample the exact posterior
};

struct ParticleOptions {
  int particles = default_particles;
  ParticleNumbers numbers = ParticleNumbers::fixed;
  /// Of `log_likelihood`. Its index lies beyond those of populations.
  StreamKey key = {.seed = 1, .purpose = Purpose::particle, .index = std::uint64_t{1} << 40};
  /// Fixed numbers are kept up to this size, else drawn again for every vector.
  std::size_t stored_bytes = std::size_t{64} << 20;
};

/// The standard normal numbers of one estimate, by experiment: what a chain of a pseudo-marginal sampler keeps beside its
/// parameters.
using ParticleAuxiliary = std::vector<std::vector<double>>;

/// How many particles an estimate needs.
struct ParticleNeed {
  int particles = 0;
  double sd = 0;  // of the log of the estimate with so many
};

/// Experiments are independent given the parameters: their estimates multiply. An estimate is a function of the parameters and of
/// standard normal numbers, and unbiased in its mean over these. `log_likelihood` is one function of the parameters, as that of
/// every target, but rough: with fixed numbers and several states where the descendants of a particle change, with numbers of the
/// parameters everywhere.
class ParticleTarget : public Target {
 public:
  /// model: particle_model of the space's model, for the method of options.solver. experiments: those of the space, in its order.
  /// Starts are not estimated from rows: options.start_rows = 0.
  ParticleTarget(std::shared_ptr<ParticleModel const> model, std::shared_ptr<ParameterSpace const> space,
                 std::vector<Experiment> experiments, TargetOptions options, ParticleOptions particles = {});
  ~ParticleTarget() override;

  int dimension() const override { return space_->dimension(); }
  std::span<ParameterInfo const> parameters() const override { return space_->infos(); }
  void sample_prior(StreamKey key, Lanes theta) const override { space_->sample_prior(key, theta); }
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian = true) const override {
    space_->log_prior(theta, out, jacobian);
  }
  void log_reference(ConstLanes theta, std::span<double> out) const override { space_->log_reference(theta, out); }
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override;
  /// One row, sqrt(2 (C - log likelihood)): what is fitted here is no sum of squares.
  int residual_count() const override { return 1; }
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override;
  bool is_expensive() const override { return true; }
  bool is_estimated() const override { return true; }
  double roughness() const override;
  void constrain(ConstLanes theta, Lanes declared) const override { space_->constrain(theta, declared); }
  void unconstrain(ConstLanes declared, Lanes theta) const override { space_->unconstrain(declared, theta); }

  /// Independent estimates: lane w by the numbers of key.with_index(key.index + w).
  void estimate(ConstLanes theta, StreamKey key, std::span<double> out, Ledger& ledger) const;
  /// Lane w by its own numbers, auxiliary[w]. With those of `draw_auxiliary(key)` the value is that of `estimate` with the key.
  void estimate(ConstLanes theta, std::span<ParticleAuxiliary const> auxiliary, std::span<double> out, Ledger& ledger) const;
  ParticleAuxiliary draw_auxiliary(StreamKey key) const;
  /// The autoregressive step of a chain with correlated estimates: each number u becomes rho u + sqrt(1 - rho^2) e.
  void move_auxiliary(ParticleAuxiliary& auxiliary, double correlation, StreamKey key) const;

  /// Particles with which the log of an estimate at theta [P x 1] has about this sd, found from `repeats` estimates with each of a
  /// few numbers of particles; at most `most`.
  ParticleNeed needed(ConstLanes theta, StreamKey key, double sd = 1, int repeats = 32, int most = 1 << 16) const;
  /// Instructions that one particle takes along all experiments, roughly.
  double work() const;
  /// The same target with another number of particles.
  std::unique_ptr<ParticleTarget> with_particles(int particles) const;

  /// The same target with other numbers behind `log_likelihood`.
  std::unique_ptr<ParticleTarget> with_numbers(ParticleNumbers numbers) const;

  /// What one run by the fixed numbers sees at theta [P x 1] in an experiment.
  FilterOutcome look(ConstLanes theta, int experiment, SeeParticles const& see) const;

  std::shared_ptr<ParticleModel const> const& model() const { return model_; }
  std::shared_ptr<ParameterSpace const> const& space() const { return space_; }
  std::vector<Experiment> const& experiments() const { return *experiments_; }
  int particles() const { return particles_.particles; }

 private:
  using Simulators = std::vector<Simulator>;
  using MakeNormals = std::function<std::unique_ptr<ParticleNormals>(int lane, int experiment)>;
  ParticleTarget(ParticleTarget const& other, ParticleOptions particles);
  void run(ConstLanes theta, int particles, MakeNormals const& normals, std::span<double> out, Ledger& ledger) const;
  ParticleFilter filter(int experiment, int particles) const;
  LaneArray parameters(ConstLanes values, int experiment) const;
  StreamKey key_of(StreamKey key, int experiment) const;
  std::unique_ptr<ParticleNormals> fixed_normals(int experiment) const;
  void record(ConstLanes theta, std::span<FilterOutcome const> outcomes, Ledger& ledger) const;

  std::shared_ptr<ParticleModel const> model_;
  std::shared_ptr<ParameterSpace const> space_;
  std::shared_ptr<std::vector<Experiment> const> experiments_;
  TargetOptions options_;
  ParticleOptions particles_;
  std::shared_ptr<ThreadPool> pool_;  // absent for one thread
  std::shared_ptr<Simulators const> simulators_;
  Lazily<ParticleAuxiliary> stored_;  // of the fixed key
};

}  // namespace sysid
