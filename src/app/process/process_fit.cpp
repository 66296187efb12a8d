// Separates the parts of models with Gaussian processes, and builds their targets.
#include "app/process/process_fit.hpp"

#include "app/session/fit_target.hpp"
#include "data/start_rule.hpp"

namespace sysid {

std::shared_ptr<ProcessModel const> process_model(Session const& session, FitTask const& fit, PredictionRule prediction) {
  auto ruled = with_prediction(session.file.models[static_cast<std::size_t>(fit.model)], prediction);
  if (!ruled) throw InternalError("a prediction rule was let through that the model has no data for");
  return std::make_shared<ProcessModel const>(std::move(*ruled), fit.start.kind == StartRule::Kind::estimated, fit.solver.method);
}

std::unique_ptr<ProcessTarget> process_target(FitTask const& fit, std::shared_ptr<ProcessModel const> model,
                                              std::vector<Experiment> experiments, SolverSettings const& solver,
                                              ExecutionOptions const& execution) {
  TargetOptions options;
  options.solver = solver;
  options.start_rows = start_rows(fit.start);
  options.execution = execution;
  auto const space = parameter_space(model->reduced(), fit.experiments);
  return std::make_unique<ProcessTarget>(std::move(model), space, std::move(experiments), std::move(options));
}

std::shared_ptr<CompiledModel const> compile_parametric(ProcessModel const& model, bool free_start, std::string const& method) {
  Model parametric = model.model();
  remove_processes(parametric);
  return compile(std::move(parametric), free_start, method);
}

}  // namespace sysid
