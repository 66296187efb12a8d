// The likelihood of one parameter vector in one experiment, estimated by weighted particles.
#pragma once
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "core/numeric/lanes.hpp"
#include "likelihood/particle/particle_model.hpp"
#include "likelihood/particle/particle_normals.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

struct FilterOutcome {
  double log_likelihood = 0;    // -infinity where no particle is left
  int sample = -1;              // where that was
  double least_effective = 1;   // the smallest effective part of the particles, (sum w)^2/(N sum w^2), over the weighed samples
  int least_effective_at = -1;  // the sample where it is
};

/// What is to be seen at each sample that is weighed, before particles are resampled: their states [S x N], the model's own first.
struct WeighedParticles {
  int sample;
  ConstLanes states;
  std::span<double const> weights;  // their sum is 1
};
using SeeParticles = std::function<void(WeighedParticles const&)>;

/// The same at each sample before it is weighed: what the samples before it say of it.
struct PredictedParticles {
  int sample;
  ConstLanes states;
  std::span<double const> weights;
  ConstLanes densities;  // of the channels, logarithms; means nothing where the channel is not weighed
};

/// The means of disturbances over a sampling interval, in the order of the model's noises: of intensity 1; of those that keep their
/// value from sample to sample, of variance 1.
struct IntervalMeans {
  int sample;         // at which the interval begins
  ConstLanes values;  // [noises x N]; the particles are those of `predicted` at the next sample
};

/// Who looks at a run; what is not given is not called. It goes on to the end of the record, weighed or not.
struct ParticleView {
  /// What `predicted` sees of a sample is known from those so many rows before it and earlier; beyond 1 without densities.
  int ahead = 1;
  std::function<void(PredictedParticles const&)> predicted;
  std::function<void(IntervalMeans const&)> moved;  // before that
  SeeParticles weighed;                             // at each sample, also where nothing was to be weighed
  /// After that, where particles are chosen anew: particle w becomes what ancestors[w] was, all of equal weight. weights: before.
  std::function<void(std::span<int const> ancestors, std::span<double const> weights)> resampled;
};

/// The bootstrap filter: particles move by the model's own dynamics from sample to sample with fresh numbers, are weighed by the
/// density of what was measured, and are resampled where the weights W are worth less than half of them.   Gordon, Salmond, Smith
/// 1993
///
///   log L = sum over samples i of log sum_j W_j p(y_i | state of particle j),  E L = p(y)      Del Moral 2004, sec. 7.4.1
///
/// Immutable; may be run concurrently.
class ParticleFilter {
 public:
  /// simulator: of the densities of `model`; both must outlive it. particles > 0.
  ParticleFilter(ParticleModel const& model, Simulator const& simulator, int particles);

  /// Standard normal numbers that a run takes.
  std::size_t numbers() const;
  /// As many as that, as a run with `normals` would take them.
  std::vector<double> draw(ParticleNormals& normals) const;
  /// parameters [.. x 1]: those of the model, SI.
  FilterOutcome run(ConstLanes parameters, ParticleNormals& normals, SeeParticles const& see = nullptr) const;
  /// The same, looked at along the whole record; takes numbers beyond `numbers()` where the record goes on behind its last sample.
  FilterOutcome run(ConstLanes parameters, ParticleNormals& normals, ParticleView const& view) const;

 private:
  ParticleModel const& model_;
  Simulator const& simulator_;
  int particles_;
};

}  // namespace sysid
