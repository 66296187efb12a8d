// Fits of models with Gaussian processes, and what they predict.
#pragma once
#include <memory>

#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/process/process_forecast.hpp"
#include "likelihood/process/process_target.hpp"

namespace sysid {

/// A model of the file taken apart, under a prediction rule.
std::shared_ptr<ProcessModel const> process_model(Session const& session, FitTask const& fit, PredictionRule prediction);

/// The target of a fit, holding its samples. data: those of the fit. solver: of differential equations, where there are any.
std::unique_ptr<ProcessTarget> process_target(FitTask const& fit, std::shared_ptr<ProcessModel const> model,
                                              std::vector<ExperimentData> const& data, SolverSettings const& solver,
                                              ExecutionOptions const& execution);

ExitCode run_process_fit(Session& session, int index, Task const& task, FitTask const& what);
ExitCode run_process_predict(Session& session, Task const& task, PredictTask const& what);

}  // namespace sysid
