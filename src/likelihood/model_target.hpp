// The Target of one model on one experiment: what samplers and optimisers see. Nothing of the language passes beyond this file.
#pragma once
#include <functional>
#include <memory>

#include "likelihood/compiled_model.hpp"
#include "likelihood/start_state.hpp"
#include "likelihood/target.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

struct TargetOptions {
  SolverSettings solver;  // of the method that the model was compiled for
  int start_rows = 0;     // > 0: the start state is estimated from so many rows
  ExecutionOptions execution;
  std::function<std::string(NodeId, Graph const&)> describe;  // a sub-expression in the user's words, for the ledger
};

class ModelTarget : public Target {
 public:
  /// compiled: with a free start exactly when options.start_rows > 0.
  ModelTarget(std::shared_ptr<CompiledModel const> compiled, Experiment experiment, TargetOptions options);

  int dimension() const override { return static_cast<int>(compiled_->sampled.size()); }
  std::span<ParameterInfo const> parameters() const override { return infos_; }
  void sample_prior(StreamKey key, Lanes theta) const override;
  void log_prior(ConstLanes theta, std::span<double> out, bool jacobian = true) const override;
  void log_likelihood(ConstLanes theta, std::span<double> out, Ledger& ledger) const override;
  int residual_count() const override;
  void residuals(ConstLanes theta, Lanes out, Ledger& ledger) const override;
  void constrain(ConstLanes theta, Lanes declared) const override;
  void unconstrain(ConstLanes declared, Lanes theta) const override;

  CompiledModel const& compiled() const { return *compiled_; }
  Experiment const& experiment() const { return experiment_; }
  TargetOptions const& options() const { return options_; }
  /// The channel and sample each residual row belongs to; the last rows, one per channel, carry the scale: sample -1.
  struct ResidualPlace {
    int channel, sample;
  };
  std::vector<ResidualPlace> const& residual_places() const { return places_; }

 private:
  /// theta [D x W] -> all parameter rows, SI, the start state included.
  LaneArray simulation_parameters(ConstLanes theta) const;
  void record_failures(Simulator const& simulator, LaneArray const& parameters, std::span<Outcome const> outcome, ConstLanes theta,
                       Ledger& ledger) const;

  std::shared_ptr<CompiledModel const> compiled_;
  Experiment experiment_;
  TargetOptions options_;
  std::vector<ParameterInfo> infos_;
  Simulator likelihood_, residuals_;
  std::unique_ptr<StartState> start_;
  std::vector<ResidualPlace> places_;
};

}  // namespace sysid
