// What a fit with `filter = particle` has in the place of a likelihood that can be computed: the estimates that it samples by, and
// the states, innovations and bands that particles show.
#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "diagnostics/residuals/residual_checks.hpp"
#include "likelihood/particle/particle_target.hpp"
#include "likelihood/particle/particle_trajectory.hpp"
#include "result/mode.hpp"
#include "result/report.hpp"

namespace sysid {

class FittedParticles {
 public:
  /// model: as it is fitted. All outlive it.
  FittedParticles(Session& session, FitTask const& what, Model const& model, std::vector<ExperimentData> const& data,
                  std::uint64_t seed);
  ~FittedParticles();

  /// The posterior that chains sample. modes: of the search, the highest first; where no number of particles is stated, the first
  /// of them needs so many. The same modes, seed and task give the same target.
  Target const& set_target(std::shared_ptr<ParameterSpace const> space, SolverSettings const& solver,
                           ExecutionOptions const& execution, std::vector<Mode> const& modes);

  /// The same with another solver, and four times the particles, so that differences are those of the solvers.
  std::unique_ptr<Target> with_solver(std::shared_ptr<ParameterSpace const> space, SolverSettings const& solver,
                                      ExecutionOptions const& execution) const;

  /// parameters: of the model in each experiment, SI [parameters x 1].
  FitCheck check_residuals(std::vector<LaneArray> const& parameters) const;
  /// parameters: of the model in experiment e, SI [parameters x draws].
  Trajectory::Result along(int e, ConstLanes parameters) const;
  /// Of the same.
  Prediction states(int e, ConstLanes parameters) const;
  /// Whether there are enough particles: for the estimates at these draws, declared [P x some], and at each sample at these
  /// parameters.
  Findings check(std::vector<LaneArray> const& parameters, ConstLanes draws) const;
  /// What was chosen, for the user.
  std::string chosen() const;
  Facts settings() const;

 private:
  /// What one passage of the particles of all draws has shown: bands and states are of the same draws.
  ParticleTrajectory::Result const& seen(int e, ConstLanes parameters) const;
  ParticleTrajectory const& trajectory(int e) const;
  Experiment const& experiment(int e) const { return data_[static_cast<std::size_t>(e)].experiment; }
  StreamKey key_of(int e) const;
  std::optional<Finding> check_estimates(ConstLanes draws) const;
  std::optional<Finding> check_lines() const;
  /// At these parameters, found once.
  std::vector<ParticleInnovations> const& innovations(std::vector<LaneArray> const& parameters) const;

  Session& session_;
  FitTask const& what_;
  Model const& model_;
  std::vector<ExperimentData> const& data_;
  std::uint64_t seed_;
  std::optional<SolverSettings> solver_;
  ExecutionOptions execution_;
  std::shared_ptr<ParticleModel const> particle_model_;
  std::unique_ptr<ParticleTarget> target_;
  ParticleNeed need_;
  double around_ = 0;  // sd of the log of an estimate that three in four places around the mode do not exceed
  mutable std::vector<std::unique_ptr<ParticleTrajectory>> trajectories_;
  mutable std::map<int, std::optional<ParticleTrajectory::Result>> seen_;
  mutable std::vector<ParticleInnovations> innovations_;
};

}  // namespace sysid
