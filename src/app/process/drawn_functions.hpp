// Functions drawn from the prior of a model's Gaussian processes, for data that are made.
#pragma once
#include <memory>
#include <vector>

#include "likelihood/process/process_model.hpp"
#include "likelihood/trajectory.hpp"

namespace sysid {

/// One function of each process, known where it has been asked: at the arguments that a run of the model without them reaches. A
/// value depends on the arguments up to its sample alone (it is a row of Cholesky's factor times normal numbers), so that in rounds
/// of runs and values at least one more sample comes right each time, also where values feed back into arguments.
class DrawnFunctions {
 public:
  /// model: with processes, under the rule that it is simulated by. parameters: of it, SI [parameters x 1].
  DrawnFunctions(Model const& model, std::string const& method, ConstLanes parameters, StreamKey key);

  /// The model with an input for each process behind its own, and their arguments among the quantities of its trajectories.
  std::shared_ptr<CompiledModel const> const& compiled() const { return compiled_; }
  /// Values along a run of `compiled`, SI [processes][samples]: all processes of a channel as their sum, which its first one stands
  /// for. UserError where a covariance cannot be decomposed.
  std::vector<std::vector<double>> along(Trajectory::Result const& run) const;

 private:
  ProcessModel model_;
  std::shared_ptr<CompiledModel const> compiled_;
  LaneArray covariance_;                // hyper-parameters
  std::vector<std::size_t> arguments_;  // of all processes, among the quantities of a trajectory
  StreamKey key_;
};

/// The same of finite sums: draws their coefficients, rows of `parameters` (of the model, SI [parameters x 1]) where they are not a
/// number, by streams (key, step: the number of the function). Returns what a file's head says of each function.
std::vector<std::string> draw_coefficients(Model const& model, StreamKey key, Lanes parameters);

}  // namespace sysid
