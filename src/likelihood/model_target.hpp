// The Target of one model on its experiments: what samplers and optimisers see. Nothing of the language passes beyond this file.
#pragma once
#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "likelihood/parameter_space.hpp"
#include "likelihood/start_state.hpp"
#include "likelihood/target.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

struct TargetOptions {
  SolverSettings solver;  // of the method that the model was compiled for
  int start_rows = 0;     // > 0: the start state of each experiment is estimated from so many rows
  ExecutionOptions execution;
  std::function<std::string(NodeId, Graph const&)> describe;  // a sub-expression in the user's words, for the ledger

  /// `Target::roughness` of a density of simulations of the model.
  double roughness(Model const& model) const { return model.integrated() && !solver.fixed_step() ? solver.relative : 0; }
};

/// The log likelihood is the sum over the experiments, in their order, of that of each; residual rows follow one another in the
/// same order. Experiments differ in times, inputs, rows, start and in the parameters that are theirs; a channel that one does not
/// measure takes no part there. Threads share (block of lanes, experiment). Lanes that differ in nothing that an experiment reads
/// are one simulation of it, and count as one.
class ModelTarget : public Target {
 public:
  /// compiled: with a free start exactly when options.start_rows > 0. experiments: those of the space, in its order.
  ModelTarget(std::shared_ptr<CompiledModel const> compiled, std::shared_ptr<ParameterSpace const> space,
              std::vector<Experiment> experiments, TargetOptions options);
  /// One experiment that has nothing of its own.
  ModelTarget(std::shared_ptr<CompiledModel const> compiled, Experiment experiment, TargetOptions options);
  ~ModelTarget() override;

  int dimension() const override { return space_->dimension(); }
  std::span<ParameterInfo const> parameters() const override { return space_->infos(); }
  void sample_prior(StreamKey key, Lanes theta) const override { space_->sample_prior(key, theta); }
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian = true) const override {
    space_->log_prior(theta, out, jacobian);
  }
  void log_reference(ConstLanes theta, std::span<double> out) const override { space_->log_reference(theta, out); }
  void log_prior_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, bool jacobian = true) const override;
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override;
  void expect_values(double count) const override;
  int residual_count() const override;
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override;
  double roughness() const override;
  // Exact where the compiled model says so, but for single lanes where these are not finite: by differences. The value that comes
  // with a gradient is that of another program, and equal to rounding. An experiment is simulated for the coordinates that it
  // reads; by others its derivatives are 0.
  DerivativeSource derivatives() const override;
  bool climbs_by_gradient() const override;
  double derivative_cost() const override;
  void log_likelihood_gradient(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const override;
  void residuals_with_jacobian(ConstLanes theta, Lanes out, Lanes jacobian, Ledger& ledger) const override;
  void gauss_newton(ConstLanes theta, std::span<double const> steps, Lanes gradient, Lanes curvature,
                    Ledger& ledger) const override;
  void constrain(ConstLanes theta, Lanes declared) const override { space_->constrain(theta, declared); }
  void unconstrain(ConstLanes declared, Lanes theta) const override { space_->unconstrain(declared, theta); }

  std::shared_ptr<CompiledModel const> const& compiled() const { return compiled_; }
  std::shared_ptr<ParameterSpace const> const& space() const { return space_; }
  std::vector<Experiment> const& experiments() const { return experiments_; }
  TargetOptions const& options() const { return options_; }
  /// The experiment, channel and sample each residual row belongs to; per experiment the last rows, one per channel, carry the
  /// scale: sample -1.
  struct ResidualPlace {
    int experiment, channel, sample;
  };
  std::vector<ResidualPlace> const& residual_places() const { return places_; }

 private:
  struct Part;  // what simulates one experiment
  /// The different parameter vectors among the lanes of a batch, as one experiment reads them.
  struct Columns {
    LaneArray parameters;      // [parameter rows x C] of its simulations, SI, the start state included
    std::vector<int> example;  // [C] a lane that has them
    std::vector<int> of_lane;  // [W] the column of each lane
  };
  /// Of a batch in one experiment: sums of the likelihood, or sums and records of the residuals.
  struct Run {
    LaneArray sums, records, slopes;  // slopes: by an adjoint
    std::vector<Outcome> outcome;     // [C]
  };
  /// Whether a lane, and its neighbours along each coordinate, have a solution in every experiment that reads what moves.
  struct Usable {
    bool centre = true;
    std::vector<bool> ahead, behind;  // [D]
  };
  /// What one lane's residuals are in one experiment, and their slopes by the coordinates that it reads.
  using SeeSlopes = std::function<void(int experiment, int lane, Eigen::VectorXd const& residuals, Eigen::MatrixXd const& slopes)>;

  /// theta: per experiment [D x W].
  std::vector<Columns> columns_of(std::span<ConstLanes const> theta) const;
  std::vector<Columns> columns_of(ConstLanes theta) const;
  Columns different(ConstLanes values, int experiment) const;
  std::vector<Run> run_likelihood(std::vector<Columns> const& columns) const;
  std::vector<Run> run_residuals(std::vector<Columns> const& columns) const;
  /// Of a column that did not fail.
  double residual(ResidualPlace const& place, Run const& run, int column) const;
  /// theta: per experiment, as given to `columns_of`.
  void record_failures(bool of_residuals, std::vector<Columns> const& columns, std::vector<Run> const& runs,
                       std::span<ConstLanes const> theta, Ledger& ledger) const;
  void record_failures(Simulator const& simulator, int experiment, Columns const& columns, std::span<Outcome const> outcome,
                       ConstLanes theta, Ledger& ledger) const;
  std::vector<Usable> usable(std::vector<Columns> const& columns, std::vector<Run> const& runs, int width) const;
  /// Every lane that did not fail, in every experiment; differences over `steps`.
  void see_slopes(ConstLanes theta, std::span<double const> steps, Ledger& ledger, SeeSlopes const& see) const;
  void squares_by_differences(ConstLanes theta, std::span<double const> steps, Lanes gradient, Lanes curvature,
                              Ledger& ledger) const;
  void gradient_by_differences(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const;
  /// By tangents of the program; returned are the lanes that these leave to differences, whose results may be anything.
  std::vector<int> squares_by_tangents(ConstLanes theta, Lanes gradient, Lanes curvature, Ledger& ledger) const;
  /// The log likelihood and its gradient by tangents or the adjoint; returned are the lanes that these leave to differences, or
  /// where a solve failed, whose results may be anything.
  std::vector<int> gradient_by_program(ConstLanes theta, std::span<double> out, Lanes gradient, Ledger& ledger) const;
  void finish_gradients(std::vector<int> const& lanes, ConstLanes theta, std::span<double> out, Lanes gradient,
                        Ledger& ledger) const;
  Simulator const& squares(std::size_t experiment) const;
  Simulator const& gradient(std::size_t experiment) const;
  /// Of one lane in one experiment, by the parameters of the model.
  void take_squares(Simulator const& simulator, Run const& run, int column, Eigen::VectorXd& gradient,
                    Eigen::MatrixXd& curvature) const;

  std::shared_ptr<CompiledModel const> compiled_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<Experiment> experiments_;
  TargetOptions options_;
  std::shared_ptr<ThreadPool> pool_;  // absent for one thread
  std::vector<Part> parts_;
  std::vector<ResidualPlace> places_;
  std::vector<int> first_place_;  // of each experiment, and the end
};

}  // namespace sysid
