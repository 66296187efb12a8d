// Models with Gaussian processes in fits and predictions.
#pragma once
#include <memory>

#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/process/process_forecast.hpp"
#include "likelihood/process/process_target.hpp"

namespace sysid {

/// A model of the file taken apart, under a prediction rule.
std::shared_ptr<ProcessModel const> process_model(Session const& session, FitTask const& fit, PredictionRule prediction);

/// The target of a fit, holding its samples. experiments: those of the fit. solver: of differential equations, where there are any.
std::unique_ptr<ProcessTarget> process_target(FitTask const& fit, std::shared_ptr<ProcessModel const> model,
                                              std::vector<Experiment> experiments, SolverSettings const& solver,
                                              ExecutionOptions const& execution);

/// UserError (E5003) where the matrix of a channel's samples does not fit into memory; says what an evaluation takes where that is
/// much.
void require_process_work(Session& session, ProcessModel const& model, std::vector<ExperimentData> const& data);

/// The same before a prediction with so many draws along so many samples, where values that are drawn feed back: these need the
/// matrix also where the fit did without it. trained: holds the fitted samples. model: as it predicts.
void require_free_run_work(Session& session, ProcessTarget const& trained, ProcessModel const& model, std::size_t samples,
                           int draws);

/// The model with every process at zero, which derived quantities are computed with.
std::shared_ptr<CompiledModel const> compile_parametric(ProcessModel const& model, bool free_start, std::string const& method);

ExitCode run_process_predict(Session& session, Task const& task, PredictTask const& what);

}  // namespace sysid
