// What differs between the kinds of likelihood of a fit: independent noise, or Gaussian processes that are integrated out. The flow
// and the checks are the same (fit.cpp, fit_checks.cpp).
#pragma once
#include <memory>
#include <optional>
#include <vector>

#include "app/session/session.hpp"
#include "diagnostics/residuals/residual_checks.hpp"
#include "experiment/experiments.hpp"
#include "inference/backend/backend.hpp"
#include "likelihood/parameter_space.hpp"
#include "likelihood/pointwise.hpp"
#include "likelihood/target.hpp"
#include "result/report.hpp"

namespace sysid {

class ParticleTarget;

/// The fitted rows of one experiment.
struct FittedRows {
  Prediction prediction;
  Findings drift, bands;
};

class FitLikelihood {
 public:
  virtual ~FitLikelihood() = default;

  /// As it is fitted, under its prediction rule.
  virtual Model const& model() const = 0;
  /// The same without parameters that are integrated out.
  virtual Model const& sampled_model() const = 0;
  /// All parameters of `model` that have a prior, those that are integrated out too.
  virtual ParameterSpace const& space() const = 0;
  /// Of the sampled parameters, as declared, where members of hierarchies may have other coordinates; else null.
  virtual ParameterSpace const* with_hierarchies() const = 0;
  /// The coordinates of these members in all targets that are made from here on. Throws checkpoint::Mismatch where there are no
  /// such members.
  virtual void standardise(std::vector<MemberCoordinate> const& members) = 0;
  /// What stands in the place of draws where priors are improper, in all spaces and targets from here on. Throws
  /// checkpoint::Mismatch where no prior of that coordinate is.
  virtual void refer(std::vector<ImproperReference> const& references) = 0;
  /// solver: of the task's method, or of any other to try.
  virtual std::unique_ptr<Target> make_target(std::vector<Experiment> experiments, SolverSettings const& solver,
                                              ExecutionOptions const& execution) const = 0;
  /// The same with another filter of random states; null where none has one.
  virtual std::unique_ptr<Target> with_filter(FilterRule, std::vector<Experiment>, SolverSettings const&,
                                              ExecutionOptions const&) const {
    return nullptr;
  }
  /// Estimates of the likelihood of these experiments by particles; null where there are none.
  virtual std::shared_ptr<ParticleTarget const> by_particles(std::vector<Experiment>, SolverSettings const&,
                                                             ExecutionOptions const&) const {
    return nullptr;
  }
  /// Log densities of the samples of these experiments that are scored, one series for each experiment and channel, with these
  /// values of the sampled parameters, declared; empty where samples are not independent given the trajectory.
  virtual std::vector<std::vector<double>> log_densities(std::vector<Experiment> const& experiments, SolverSettings const& solver,
                                                         std::vector<double> const& sampled) const = 0;
  /// The same of one of the fit's own experiments, for any draws and rows; null where samples are not independent given the
  /// trajectory.
  virtual std::unique_ptr<PointwiseLikelihood> pointwise(int experiment) const = 0;
  /// Before `set_target`: where the posterior has its modes, the highest first.
  virtual void know_modes(std::vector<Mode> const&) {}
  /// How the likelihood of the target that was set is estimated; empty where it is computed.
  virtual std::string estimated_by() const { return {}; }
  /// The same estimates with more particles, by the solver of that target and by the next finer one; null where the likelihood is
  /// computed.
  struct FinerEstimates {
    std::unique_ptr<Target> coarse, fine;
  };
  virtual FinerEstimates finer_estimates(ExecutionOptions const&) const { return {}; }
  /// Whether the estimates are good enough.
  virtual Findings check_particles(FitResult const&) const { return {}; }
  /// The target of the fit's own experiments, which the functions below read.
  virtual Target const& set_target(SolverSettings const& solver, ExecutionOptions const& execution) = 0;

  /// All parameters in the order of `space`, then derived quantities.
  virtual Draws draws(FitResult const& result) const = 0;
  /// Of the parameters in the order of `space`.
  virtual std::vector<Summary> summaries(FitResult const& result, Draws const& draws) const = 0;
  /// Scores per channel and what the residuals, or the samples left out one by one, show. draws: as above.
  virtual FitCheck check_residuals(FitResult const& result, Draws const& draws) const = 0;
  virtual std::vector<FunctionReport> functions(FitResult const& result, Draws const& draws) const = 0;
  /// Whether finite sums that stand for unknown functions can be trusted.
  virtual Findings check_functions(FitResult const& result) const = 0;
  /// Where finite sums are read outside their range, with these values of the sampled parameters, declared.
  virtual Findings check_ranges(std::vector<double> const& sampled, SolverSettings const& solver) const = 0;
  /// Bands along an experiment, constraints and values that are undefined there. Restoring forces are added to `forces`.
  virtual FittedRows fitted_rows(Draws const& draws, int experiment, std::vector<RestoringForce>& forces) const = 0;
  /// Random states and disturbances along an experiment, given all its samples; nothing where states are known.
  virtual std::optional<Prediction> states(Draws const& draws, int experiment) const = 0;
  /// What the report's settings hold beside those of every fit.
  virtual Facts settings() const = 0;
};

/// data: outlives the result.
std::unique_ptr<FitLikelihood> independent_likelihood(Session& session, FitTask const& what,
                                                      std::vector<ExperimentData> const& data, std::uint64_t seed);
std::unique_ptr<FitLikelihood> process_likelihood(Session& session, FitTask const& what, std::vector<ExperimentData> const& data,
                                                  std::uint64_t seed);

}  // namespace sysid
