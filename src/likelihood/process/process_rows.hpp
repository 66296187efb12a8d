// The rows that a Gaussian process sees of an experiment: its inputs, the parametric part, and the slopes of linear coefficients.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "likelihood/process/process_model.hpp"
#include "likelihood/start_state.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// Of one channel, SI.
struct ProcessRows {
  Eigen::MatrixXd inputs;      // [N x D]
  Eigen::VectorXd parametric;  // F [N]
  Eigen::MatrixXd slopes;      // dF/d(coefficients) [N x p]
};

/// One experiment through the parametric part of a model.
class ProcessRecord {
 public:
  ProcessRecord(std::shared_ptr<ProcessModel const> model, Experiment const& experiment, SolverSettings const& solver,
                int start_rows, ExecutionOptions const& options, std::shared_ptr<ThreadPool> pool = nullptr);

  int samples() const { return simulator_.schedule().samples(); }
  Experiment const& experiment() const { return simulator_.schedule().experiment(); }
  Simulator const& simulator() const { return simulator_; }
  /// The samples of a channel that are fitted, in their order, and what was measured there, SI.
  std::vector<int> const& fitted(int channel) const { return fitted_[static_cast<std::size_t>(channel)]; }
  Eigen::VectorXd measured(int channel) const;

  /// parameters: of the model [parameters x W], SI. The records of all samples; a lane that fails is NaN.
  struct Records {
    LaneArray parameters;  // with an estimated start
    LaneArray values;
    std::vector<Outcome> outcome;
  };
  Records run(ConstLanes parameters) const;
  /// The rows of a channel at some samples in one lane.
  ProcessRows rows(Records const& records, int channel, int lane, std::vector<int> const& samples) const;

 private:
  std::shared_ptr<ProcessModel const> model_;
  Simulator simulator_;
  std::unique_ptr<StartState> start_;
  std::vector<std::vector<int>> fitted_;
};

}  // namespace sysid
