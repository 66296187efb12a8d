// One model of a task while `check` looks ahead: its data, its solvers from coarse to fine, and how much work that may be.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/preflight/check_information.hpp"
#include "app/preflight/prior_simulations.hpp"
#include "app/session/session.hpp"
#include "core/system/lazily.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/output.hpp"
#include "result/check_page.hpp"

namespace sysid {

/// How much is looked at, so that a check of a large model ends about when that of a small one does.
struct Effort {
  int prior_draws = 128;
  int candidates = 24;  // draws among which those are sought whose slopes are taken,
  int examined = 8;     // so many; 0: slopes would take too long
  int refinements = 6;  // of the solver
};

class Preflight {
 public:
  Preflight(Session& session, FitTask const& stated, std::vector<ExperimentData> const& data, PreflightPage& page);

  Session& session;
  SolverSettings stated;  // by the task
  FitTask what;           // with fewer steps of its solver between two samples, where so many would take long
  PreflightPage& page;
  std::shared_ptr<CompiledModel const> compiled;
  std::shared_ptr<ParameterSpace const> space;
  std::optional<Finding> scales;  // `time_scales_apart`: then no advice on solvers
  std::string sticking;           // what to do about dry friction, in place of advice on solvers; empty without
  std::vector<Experiment> experiments;
  bool exact_steps = true;  // suit all experiments, whole
  bool shortened = false;   // to their `rows_ahead`
  Effort effort;
  double step_work = 0;                 // operations of the equations at the steps of one trajectory, with the stated solver
  std::vector<SolverSettings> solvers;  // as stated, then ever finer

  static constexpr std::size_t most_scored = 10000;  // rows with a sample of an experiment that are looked at, about
  static constexpr double smooth_enough = 1e-8;      // tolerance of adaptive steps under differences

  /// By one of the solvers; the rows of finer and finer ones take long to tabulate, so each is made when it is first asked for.
  Output const& output(std::size_t solver = 0) const;
  /// The same along other experiments.
  Output output_along(std::vector<Experiment> const& along) const;
  /// One that ends its steps where the equations jump; null where they do not.
  Output const* output_on_jumps() const;
  /// Of a trajectory with the stated solver, in trajectories of one step of rk4 for each substep, about.
  double solver_work() const;
  Model const& model() const { return compiled->model; }
  /// Whether its solver may take fewer steps here than the task allows.
  bool bounded() const { return what.solver.steps < stated.steps; }
  bool candidate() const { return !page.candidate.empty(); }
  /// Whether the task makes the solver finer until the result has converged: fits do, selections take theirs as it is.
  bool refines_solver() const { return what.refine_solver && !candidate(); }
  void add(FindingCode code, Severity severity, std::vector<std::string> names, std::string message, std::string help) const;
  /// Rows [first, end) of the predictions: one channel of one experiment each.
  std::vector<std::pair<int, int>> responses() const;

 private:
  Output output_of(std::shared_ptr<CompiledModel const> const& with_method, SolverSettings const& solver) const;
  void bound_steps();

  std::shared_ptr<ThreadPool> pool_;
  bool jumps_ = false;
  std::vector<Lazily<Output>> outputs_;  // [solvers]
  Lazily<Output> on_jumps_;
};

/// Draws of the prior in SI, all rows of a point; what only the noise reads at its median, so that one level of noise stands for
/// all.
struct PriorDraws {
  LaneArray theta;   // [P x draws], the sampler's coordinates
  LaneArray points;  // [point rows x draws]
  PriorSimulations simulations;
  std::vector<AssessedParameter> coordinates;
  std::string noise;  // the level of noise taken, in words; empty: stated
};
PriorDraws draw_prior(Preflight const& preflight);

/// Ranges and failures of the draws, with findings, onto the page; the draws that predict all channels of about the size measured,
/// nearest first.
std::vector<int> describe_prior(Preflight const& preflight, PriorDraws const& prior);

/// `initial_far_off` where every draw begins far from the first sample of a channel, in units of its noise and of what it measures
/// in all, and the second sample is near the first: an initial value in another unit, or of another quantity.
void check_initial(Preflight const& preflight, PriorDraws const& prior);

/// A draw whose response ever finer solvers leave where it is, with its slopes.
struct LocalResponse {
  LocalSlopes slopes;
  double moved = 0;  // by the first refinement: of a channel's response, the largest part of its sd
  double shift = 0;  // the same as a mean square in units of the noise
};
/// Up to Effort::examined of the draws given, in their order.
std::vector<LocalResponse> local_responses(Preflight const& preflight, PriorDraws const& prior, std::vector<int> const& draws);

/// Findings on which of each disturbance and the noise of the measurement the record can tell apart, at the draws given.
void describe_disturbances(Preflight const& preflight, PriorDraws const& prior, std::vector<int> const& draws);

/// Which solver the result needs, or the distances of a selection do; fills page.information, which is there.
void describe_solvers(Preflight const& preflight, PriorDraws const& prior, std::vector<LocalResponse> const& responses);

}  // namespace sysid
