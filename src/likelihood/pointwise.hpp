// The log likelihood sample by sample: for leave-one-out estimates and other programs.
#pragma once
#include <memory>
#include <vector>

#include "likelihood/compiled_model.hpp"
#include "likelihood/start_state.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

class PointwiseLikelihood {
 public:
  /// start_rows > 0: the compiled model has a free start, fitted to the experiment's first rows. Where states are random, a density
  /// is that of a sample given those before it; in an experiment that says which rows correct the states, given those of them.
  PointwiseLikelihood(std::shared_ptr<CompiledModel const> compiled, Experiment const& experiment, SolverSettings const& solver,
                      int start_rows, ExecutionOptions options);

  /// The samples of a channel that the likelihood reads, as indices into the experiment's rows.
  std::vector<int> const& samples(int channel) const { return samples_[static_cast<std::size_t>(channel)]; }
  /// values[c][w][k]: log density of sample samples(c)[k] of channel c under parameter vector w, of the declared unit; their sum
  /// is the log likelihood of the experiment. NaN throughout where the solve fails. parameters: of the model, SI [parameters x W].
  std::vector<std::vector<std::vector<double>>> run(ConstLanes parameters) const;

  int channels() const { return static_cast<int>(samples_.size()); }
  /// The same numbers as they are recorded, of rows [first, last): channel c at row i is row (i - first) * channels() + c of out
  /// [.. x W]. Simulated from the beginning of the record; NaN in lanes whose solve fails before `last`.
  void records(ConstLanes parameters, int first, int last, Lanes out) const;

 private:
  std::shared_ptr<CompiledModel const> compiled_;
  Simulator simulator_;
  std::unique_ptr<StartState> start_;
  std::vector<std::vector<int>> samples_;
  int end_ = 0;  // behind the last of them
};

}  // namespace sysid
