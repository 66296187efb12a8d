// The posterior density of a fit as a function, for programs that bring a sampler or an optimiser of their own.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "app/fit/fit_likelihood.hpp"
#include "app/session/preparation.hpp"
#include "app/session/session.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// The density that a fit samples, on the same data. Until `prepare` it is that of the solver and the coordinates that the file
/// states. All const members may be called from several threads at once.
class FitDensity {
 public:
  /// index: of a fit task of the session's file. Reads its data; UserError as a fit. The session outlives the density.
  FitDensity(Session& session, int index);

  /// Does what a fit does before its first sample: finds the modes, the coordinates of members of hierarchies and the solver, which
  /// the density has from here on. False: interrupted. UserError where a fit would end with one.
  bool prepare(std::uint64_t seed);

  /// Its prior and likelihood, by the unconstrained coordinates; see likelihood/target.hpp.
  Target const& target() const { return *target_; }
  /// Priors of the sampled parameters as the file states them, in the order of the coordinates.
  std::vector<PriorInfo> priors() const;
  SolverSettings const& solver() const { return preparation_.solver; }
  /// Whether time is continuous, so that a solver means something.
  bool integrated() const { return likelihood_->model().integrated(); }
  /// Those of `prepare`, the highest first; before it none.
  std::vector<Mode> const& modes() const { return preparation_.modes; }

  /// What parameter vectors predict along one of the experiments of the fit.
  struct Simulated {
    std::string experiment;    // "bench.train"
    std::vector<double> time;  // [N] s
    std::vector<TrajectoryQuantity> quantities;
    Trajectory::Result result;
  };
  int experiments() const { return static_cast<int>(data_.size()); }
  /// As the file refers to it, "bench.train".
  std::string name(int experiment) const;
  /// Of the rows of an experiment, [N] s.
  std::vector<double> const& time(int experiment) const;
  /// declared [P x W]: values of the sampled parameters, declared units. seed: of the noise. UserError (E6212) for models with
  /// Gaussian processes or an estimated filter, whose predictions are no function of the parameters.
  Simulated simulate(int experiment, ConstLanes declared, std::uint64_t seed) const;

 private:
  void set_target();

  Session& session_;
  Task const& task_;
  FitTask what_;
  std::vector<ExperimentData> data_;
  std::unique_ptr<FitLikelihood> likelihood_;
  Preparation preparation_;
  Target const* target_ = nullptr;                 // of the likelihood
  std::shared_ptr<CompiledModel const> compiled_;  // of the same solver; null with Gaussian processes
};

}  // namespace sysid
