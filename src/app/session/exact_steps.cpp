// Decided by the equations, the data and the prior together, before anything is computed.
#include "app/session/exact_steps.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "diagnostics/tolerance/step_growth.hpp"
#include "diagnostics/tolerance/tolerance.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/parameter_space.hpp"

namespace sysid {
namespace {

bool is_random(FitTask const& what, Model const& model) { return model.filtered() || !what.input_errors.empty(); }

bool may_step_exactly(FitTask const& what, Model const& model) {
  if (what.solver_stated || !what.refine_solver || !model.integrated() || what.filter == FilterRule::particle) return false;
  return is_random(what, model) || model.processes.empty();
}

/// Of the prior; 0 where it has no draws.
double share_of_growth(FitTask const& what, Model const& model, std::vector<ExperimentData> const& data) {
  if (!model.processes.empty()) return 0;
  auto const space = parameter_space(model, what.experiments);
  if (!improper_coordinates(space->infos()).empty()) return 0;
  return share_of_growing_steps(*space, experiments_of(data), what.solver);
}

}  // namespace

SuitedTask with_exact_steps(FitTask what, Model const& model, std::vector<ExperimentData> const& data) {
  if (!may_step_exactly(what, model) || !allow_exact_steps(data, model)) return {std::move(what)};
  bool const equal = std::ranges::all_of(data, [](ExperimentData const& each) { return unequal_step(each.experiment.time) == 0; });
  double growing = 0;
  if (!is_random(what, model) || !equal) {
    growing = share_of_growth(what, model, data);
    if (growing <= SearchSolver::notable) return {std::move(what)};
  }
  what.solver = {.method = std::string(exact_solver().name)};
  what.refine_solver = false;
  return {std::move(what), growing};
}

SuitedTask with_exact_steps(Session& session, FitTask what) {
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  if (!may_step_exactly(what, model) || !is_linear_in_states(model)) return {std::move(what)};
  auto const data = load_experiments(session, what.experiments, model, what.start, what.prediction, what.solver);
  return with_exact_steps(std::move(what), model, data);
}

std::string exact_notice(std::string const& name, SolverSettings const& given, SuitedTask const& suited) {
  return fmt::format(
      "{}: the exact solver {} is used, because with {} the integration is unstable for {:.0f} % of the prior draws\n", name,
      suited.task.solver.method, accuracy(given), 100 * suited.growing);
}

SolverSettings solver_along(Session& session, FitTask const& fit, SolverSettings const& fitted,
                            std::vector<ExperimentUse> const& along, PredictTask const& what) {
  Model const& model = session.file.models[static_cast<std::size_t>(fit.model)];
  if (!fitted.row().exact || !may_step_exactly(fit, model)) return fitted;
  auto const data = load_experiments(session, along, model, what.start, what.prediction);
  return allow_exact_steps(data, model) ? fitted : SolverSettings{.method = std::string(adaptive_solver().name)};
}

}  // namespace sysid
