// `fit`: the back end with its settings, start, solver.
#include "check/task_checker.hpp"

#include <algorithm>

#include "check/errors.hpp"

namespace sysid {

FitTask TaskChecker::fit() {
  FitTask task;
  std::vector<std::string> names;
  for (BackendSettings const& backend : backends_) names.emplace_back(backend.name);
  auto const model = item(tree_.subject, names_.models, "model");
  if (model) task.model = *model;
  if (model && file_.models[static_cast<std::size_t>(*model)].channels.empty()) {
    diagnostics_.add(errors::nothing_observed(tree_.subject));
    return task;
  }
  task.experiments = experiments(model ? &file_.models[static_cast<std::size_t>(*model)] : nullptr, "to");
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    auto const backend = std::find_if(backends_.begin(), backends_.end(), [&](auto const& each) { return each.name == key; });
    if (!option.input && !option.key && backend != backends_.end()) {
      if (!options_.fresh(option, the_backend)) continue;
      task.backend = key;
      task.settings = Settings(backend->settings);
      if (ast::Call const* call = as_call(option.value)) options_.settings(*call, backend->settings, task.settings);
    } else if (!option.input && option.key && key == "start") {
      if (options_.fresh(option, key)) options_.start(option, task.start);
    } else if (!option.input && option.key && (key == "substeps" || key == "solver")) {
      if (options_.fresh(option, key)) task.settle = !options_.solver(option, task.solver);
    } else if (!option.input && option.key && key == "prediction") {
      if (options_.fresh(option, key))
        prediction(option, model ? &file_.models[static_cast<std::size_t>(*model)] : nullptr, task.prediction);
    } else if (!option.input && option.key && key == "seed") {
      if (options_.fresh(option, key)) options_.seed(option, task.seed);
    } else if (!option.input && !option.key && !key.empty()) {
      diagnostics_.add(errors::unknown_backend({{head_span(option.value)}, key}, names));
      task.backend = key;  // said once is enough
    } else {
      options_.unknown(option, {"start", "solver", "substeps", "prediction", "seed"});
    }
  }
  if (model) {
    Model const& whole = file_.models[static_cast<std::size_t>(*model)];
    suit(task.solver, whole);
    suit(task.start, whole, tree_.options);
    if (!whole.integrated()) {  // there is nothing to solve
      task.solver = {};
      task.settle = false;
    }
  }
  if (task.backend.empty() && !diagnostics_.has_errors(before_)) diagnostics_.add(errors::backend_missing(tree_, names));
  return task;
}

}  // namespace sysid
