// Separates the parts of models with Gaussian processes, and builds their targets.
#include "app/process/process_fit.hpp"

#include <fmt/format.h>

#include "app/session/fit_target.hpp"
#include "core/system/memory.hpp"
#include "core/system/progress_terminal.hpp"
#include "core/text/words.hpp"
#include "data/scored_samples.hpp"
#include "data/start_rule.hpp"
#include "gaussian_process/regression.hpp"
#include "model/lags.hpp"

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

namespace {

constexpr double worth_saying = 2;  // s

}  // namespace

void require_process_work(Session& session, ProcessModel const& model, std::vector<ExperimentData> const& data) {
  for (ProcessChannel const& channel : model.channels()) {
    Eigen::Index rows = 0;
    for (ExperimentData const& each : data) rows += scored_count(each.experiment, static_cast<std::size_t>(channel.channel));
    if (gaussian_process::filters(channel.covariance, rows)) continue;
    auto const [bytes, seconds] = gaussian_process::dense_work(static_cast<double>(rows));
    std::string const what = fmt::format("a likelihood of {} rows with a Gaussian process", rows);
    require_memory(what, bytes, "fit fewer rows: choose them with `split` in the data block");
    if (seconds > worth_saying)
      session.notices << fmt::format("{} takes about {} of memory and {}; a fit computes thousands of them\n", what,
                                     format_bytes(bytes), format_duration(seconds));
  }
}

void require_free_run_work(Session& session, ProcessTarget const& trained, ProcessModel const& model, std::size_t samples,
                           int draws) {
  if (!feeds_back(model.model())) return;
  for (int c = 0; c < static_cast<int>(model.channels().size()); ++c) {
    int const rows = trained.count(c);
    auto const [bytes, seconds] = gaussian_process::posterior_work(rows, static_cast<double>(samples));
    std::string const what = fmt::format("a free run of a Gaussian process that is fitted to {} rows", rows);
    require_memory(what, bytes,
                   "fit fewer rows: choose them with `split` in the data block; or predict with `prediction = one_step`");
    if (seconds * draws > worth_saying)
      session.notices << fmt::format("{} takes about {} of memory and {} with {}\n", what, format_bytes(bytes),
                                     format_duration(seconds * draws), counted(draws, "draw"));
  }
}

std::shared_ptr<CompiledModel const> compile_parametric(ProcessModel const& model, bool free_start, std::string const& method) {
  Model parametric = model.model();
  remove_processes(parametric);
  return compile(std::move(parametric), free_start, method);
}

}  // namespace sysid
