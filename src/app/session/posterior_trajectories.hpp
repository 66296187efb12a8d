// What a predict task simulates: trajectories of posterior draws along its experiments. Bands, scores and files are made of them.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "diagnostics/function_ranges.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/particle/particle_trajectory.hpp"
#include "likelihood/pointwise.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// States that are random given the parameters are known from the rows before those that are predicted; in a prediction one step
/// ahead from these too.
std::vector<std::uint8_t> corrected_rows(Experiment const& experiment, PredictionRule rule);

class PosteriorTrajectories {
 public:
  /// Of a fit without processes, whose draws are those of this run or of its result folder; UserError as `fitted_model`.
  PosteriorTrajectories(Session& session, PredictTask const& what, std::uint64_t seed);

  FittedModel const& fitted() const { return fitted_; }
  SolverSettings const& solver() const { return solver_; }
  Model const& model() const { return compiled_->model; }
  std::vector<ExperimentData> const& data() const { return data_; }
  /// Trajectories per experiment.
  int wanted() const { return wanted_; }
  int start_rows() const { return free_start_ ? what_.start.rows : 0; }

  /// The experiments of the fit with the parameters of the draws there; none where their records are gone.
  std::vector<RunsAlong> fitted_runs() const;
  /// Parameters that experiment e was not fitted with and draws from their prior given the shared ones, by name.
  std::vector<std::string> drawn_from_prior(int e) const;
  /// Parameters of the model in experiment e for each draw that is used, SI [parameters x draws].
  LaneArray parameters(int e) const;
  Trajectory trajectory(int e) const;
  /// parameters: those of experiment e. moments: of the noise, too.
  Trajectory::Result run(int e, Trajectory const& trajectory, ConstLanes parameters, bool moments = false) const;
  /// Where trajectories are fewer than a band needs, as those of an optimum are: several draws of the noise about each of them in
  /// place of one, so many in all as draws are asked for, and 200 at least; behind the first of all the second of all.
  void add_noise(int e, Trajectory const& trajectory, ConstLanes parameters, Trajectory::Result& result) const;
  /// Log densities of the scored samples of experiment e.
  PointwiseLikelihood pointwise(int e) const;

 private:
  Trajectory::Result by_particles(int e, ConstLanes parameters) const;

  Session& session_;
  PredictTask const& what_;
  FittedModel const& fitted_;
  FitTask fit_;
  SolverSettings solver_;
  bool free_start_;
  std::shared_ptr<CompiledModel const> compiled_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<ExperimentData> data_;
  std::uint64_t seed_;
  int wanted_;
};

}  // namespace sysid
