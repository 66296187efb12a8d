// Decided by the equations and the data together.
#include "app/session/exact_steps.hpp"

#include <algorithm>
#include <utility>

#include "experiment/experiments.hpp"

namespace sysid {
namespace {

bool may_step_exactly(FitTask const& what, Model const& model) {
  bool const random = model.filtered() || !what.input_errors.empty();
  return what.refine_solver && random && model.integrated() && what.filter != FilterRule::particle;
}

}  // namespace

FitTask with_exact_steps(FitTask what, Model const& model, std::vector<ExperimentData> const& data) {
  bool const allowed = may_step_exactly(what, model) && std::ranges::all_of(data, [&](ExperimentData const& each) {
                         return allows_exact_steps(each.experiment, model);
                       });
  if (!allowed) return what;
  what.solver = {.method = std::string(exact_solver().name)};
  what.refine_solver = false;
  return what;
}

FitTask with_exact_steps(Session& session, FitTask what) {
  Model const& model = session.file.models[static_cast<std::size_t>(what.model)];
  if (!may_step_exactly(what, model)) return what;
  auto const data = load_experiments(session, what.experiments, model, what.start, what.prediction, what.solver);
  return with_exact_steps(std::move(what), model, data);
}

SolverSettings solver_along(Session& session, FitTask const& fit, SolverSettings const& fitted, PredictTask const& what) {
  Model const& model = session.file.models[static_cast<std::size_t>(fit.model)];
  if (!fitted.row().exact || !may_step_exactly(fit, model)) return fitted;
  auto const data = load_experiments(session, what.experiments, model, what.start, what.prediction);
  bool const suits =
      std::ranges::all_of(data, [&](ExperimentData const& each) { return allows_exact_steps(each.experiment, model); });
  return suits ? fitted : SolverSettings{.method = std::string(adaptive_solver().name)};
}

}  // namespace sysid
