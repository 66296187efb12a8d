// What a model with Gaussian processes predicts along a record, given parameters and the samples that it was fitted to.
#pragma once
#include <memory>
#include <vector>

#include "likelihood/process/process_target.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

class ProcessForecast {
 public:
  /// trained: holds the fitted samples, under the rule that it was fitted with. model: the same model under the rule to predict by;
  /// where processes feed back into later samples (a free run), they are drawn sample by sample, each given the samples that were
  /// fitted; what was drawn before is an input of it but no observation.
  ProcessForecast(std::shared_ptr<ProcessTarget const> trained, std::shared_ptr<ProcessModel const> model,
                  Experiment const& experiment, SolverSettings const& solver, int start_rows, ExecutionOptions const& options);

  /// Channels, then the parametric part of each.
  std::vector<TrajectoryQuantity> const& quantities() const { return quantities_; }

  /// One vector of parameters: fitted [parameters x fitted experiments] and own [parameters x 1], of the model, SI. `count`
  /// trajectories are added to `result`, which draws from the streams of key.with_index(first + i): values are those of the
  /// function, drawn at each sample by itself, noisy ones have the noise added. NaN where the vector has none.
  void run(ConstLanes fitted, ConstLanes own, int count, StreamKey key, std::uint64_t first, Trajectory::Result& result) const;

  /// Per channel and input of its processes, how far places lie outside the inputs fitted, in widths of their range; 0: inside;
  /// infinite where that was the same at all samples.
  struct Reach {
    std::string process, input;
    double widths = 0;
  };
  std::vector<Reach> reach(ConstLanes fitted, ConstLanes own) const;

 private:
  struct FreeRun;
  using Paths = std::vector<std::vector<std::vector<double>>>;  // [channels][trajectories][samples], SI
  /// Both give nothing but false where a covariance cannot be decomposed, or nothing can be predicted. Samples at once where
  /// nothing that is predicted is read again; a sample without inputs has no value. Else each from what was drawn before it.
  bool at_once(std::vector<ProcessTarget::Regression> const& fitted, ConstLanes own, int count, StreamKey key, std::uint64_t first,
               Paths& values, Paths& noisy, Paths& parametric) const;
  bool sample_by_sample(std::vector<ProcessTarget::Regression> const& fitted, ConstLanes own, int count, StreamKey key,
                        std::uint64_t first, Paths& values, Paths& noisy, Paths& parametric) const;

  std::shared_ptr<ProcessTarget const> trained_;
  std::shared_ptr<ProcessModel const> model_;
  ProcessRecord record_;
  std::shared_ptr<FreeRun const> free_run_;  // where processes feed back
  std::vector<TrajectoryQuantity> quantities_;
};

}  // namespace sysid
