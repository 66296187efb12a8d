// One run of the filter, looked at: what a trajectory of particles keeps of it.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "likelihood/particle/ancestry.hpp"
#include "likelihood/particle/particle_trajectory.hpp"
#include "simulate/particle_lanes.hpp"

namespace sysid {

struct ParticleTrajectory::Path {
  FilterOutcome outcome;
  bool solved() const { return outcome.sample < 0; }
  // [shown][samples], SI; of channels in their order.
  std::vector<std::vector<double>> mean, sd, drawn, noisy, noise_variance;
  std::vector<std::vector<double>> smoothed;  // [smoothed * picks][samples], SI
};

/// Of one run of the filter for one parameter vector.
class ParticleTrajectory::Recorder {
 public:
  Recorder(ParticleTrajectory const& of, ConstLanes parameters, StreamKey key, int picks, Path& path);

  /// Of the run; for the filter.
  ParticleView view();
  /// Innovations are found, too.
  void score(ParticleInnovations& innovations) { innovations_ = &innovations; }
  /// After the run.
  void end();

 private:
  enum Kind { states, averages };

  double value(NodeId id) const;
  void predicted(PredictedParticles const& particles);
  /// [arguments] of the noise of a channel for a particle.
  std::vector<double> const& arguments(std::size_t channel, std::size_t particle);
  static bool usable(DistributionRow const& row, std::vector<double> const& numbers);
  void add_noise(std::size_t c, std::size_t pick, std::span<double const> weights, std::size_t i, Stream& stream);
  void add_innovations(PredictedParticles const& particles);
  double innovation(std::size_t c, double measured, std::span<double const> weights, Stream& stream);
  void weighed(WeighedParticles const& particles);
  void add_averages(IntervalMeans const& means);
  void emit(int kind, int sample, ConstLanes values, std::span<int const> origin, std::span<double const> weights);

  ParticleTrajectory const& of_;
  ConstLanes parameters_;
  StreamKey key_;
  int picks_;
  Path& path_;
  ParticleLanes lanes_;
  Ancestry ancestry_;
  ConstLanes records_;
  ParticleInnovations* innovations_ = nullptr;
  std::vector<double> sizes_;  // of the disturbances
  std::vector<double> numbers_, last_weights_;
};

}  // namespace sysid
