// What a predict task of a model with Gaussian processes simulates: trajectories of the functions that its samples leave possible.
#pragma once
#include <memory>
#include <vector>

#include "app/process/process_fit.hpp"

namespace sysid {

class ProcessTrajectories {
 public:
  /// Of a fit with processes, whose draws are those of this run or of its result folder; UserError as `fitted_model`.
  ProcessTrajectories(Session& session, PredictTask const& what, std::uint64_t seed);

  FittedModel const& fitted() const { return fitted_; }
  Model const& model() const { return model_->model(); }
  ParameterSpace const& space() const { return *space_; }
  std::vector<ExperimentData> const& data() const { return data_; }

  /// Declared values of the draws that are used [parameters x draws].
  LaneArray draws() const;
  /// Parameters of the model in experiment e for each of these draws, SI [parameters x draws].
  LaneArray parameters(int e) const;
  ProcessForecast forecast(int e) const;
  /// parameters: those of experiment e. As many trajectories of each draw as make about those that the task asks for.
  Trajectory::Result run(int e, ProcessForecast const& forecast, ConstLanes parameters) const;

 private:
  Session& session_;
  PredictTask const& what_;
  FittedModel const& fitted_;
  FitTask const& fit_;
  std::shared_ptr<ProcessTarget const> trained_;
  std::shared_ptr<ProcessModel const> model_;
  std::shared_ptr<ParameterSpace const> space_;
  std::vector<ExperimentData> data_;
  std::uint64_t seed_;
};

}  // namespace sysid
