// `fit`: the back end with its settings, and how the model is simulated.
#include "check/message/errors.hpp"
#include "check/model/model_checker.hpp"
#include "check/task/task_checker.hpp"
#include "check/task/task_options.hpp"
#include "core/setting/table.hpp"

namespace sysid {

FitTask TaskChecker::fit() {
  FitTask task;
  auto const found = item(tree_.subject, names_.models, "model");
  Model const* model = found ? &file_.models[static_cast<std::size_t>(*found)] : nullptr;
  std::vector<int> models;
  if (found) models.push_back(task.model = *found);
  if (model != nullptr && model->channels.empty()) {
    diagnostics_.add(errors::nothing_observed(tree_.subject));
    return task;
  }
  task.experiments = experiments(model, "to");
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    if (option.key && key == "search") {
      if (options_.fresh(option, key)) search(option, task.near);
    } else if (option.key && key == "evidence") {
      if (options_.fresh(option, key)) evidence(option, task.evidence);
    } else if (option.key && key == "particles") {
      if (options_.fresh(option, key)) particles(option, task.particles);
    } else if (!simulation_option(option, key, models, task) &&
               !backend_option(option, key, backends_.fitting, task.backend, task.settings)) {
      options_.unknown(option, task_option_names("fit"));
    }
  }
  if (model != nullptr) {
    suit(task, *model);
    suit_processes(task, *model);
    report_needless_filter(task.filter);
    report_needless_solver();
  }
  if (task.backend.empty() && !diagnostics_.has_errors(before_))
    diagnostics_.add(errors::backend_missing(tree_, names_of(backends_.fitting)));
  return task;
}

void TaskChecker::search(ast::Option const& option, std::optional<int>& near) {
  if (as_word(option.value) == "everywhere") return;
  ast::Call const* call = as_call(option.value);
  auto const* fit = call != nullptr && call->function.text == "near" && call->arguments.size() == 1 && !call->arguments[0].name
                        ? std::get_if<ast::Reference>(&call->arguments[0].value.node)
                        : nullptr;
  if (fit == nullptr)
    diagnostics_.add(errors::option_kind(option.value.span, "search", {"`everywhere` or near a fit", {"everywhere"}},
                                         "search = near(posterior)"));
  else
    near = fitted_task({{fit->span}, fit->name.text}, false);
}

void TaskChecker::particles(ast::Option const& option, int& count) {
  if (as_word(option.value) == "automatic") return;
  particles_ = option.span;
  options_.whole(option, "particles", 16, 1e6, count);
}

void TaskChecker::evidence(ast::Option const& option, EvidenceMethod& method) {
  std::string const given = as_word(option.value).value_or("");
  if (auto const found = evidence_method(given))
    method = *found;
  else
    diagnostics_.add(errors::option_choice(option.value.span, "evidence", given, evidence_words()));
}

// The mode over a function's coefficients and their scale together is not near where the posterior of the scale lies.
void TaskChecker::suit_scales(Model const& model) {
  for (Expansion const& expansion : model.expansions)
    for (KernelUse const& kernel : expansion.process.kernels)
      for (NodeId const node : model.graph.reachable(kernel.hyper_parameters)) {
        if (!is_leaf(model.graph[node], LeafKind::parameter)) continue;
        Parameter const& parameter = model.parameters[static_cast<std::size_t>(model.graph[node].index)];
        if (!parameter.prior || parameter.value) continue;
        diagnostics_.add(errors::expansion_by_optimum(tree_.subject.span, expansion.name, parameter.name));
        return;
      }
}

void TaskChecker::suit_processes(FitTask const& task, Model const& model) {
  if (BackendSettings const* backend = row_named(backends_.fitting, task.backend)) {
    if (!model.expansions.empty() && !backend->prior)
      diagnostics_.add(errors::expansion_by_likelihood(tree_.subject.span, model.name));
    if (backend->optimum && backend->prior) suit_scales(model);
  }
  if (model.processes.empty()) return;
  if (model.integrated() && task.start.kind == StartRule::Kind::estimated)
    diagnostics_.add(errors::process_beside_estimated_start(tree_.subject.span, model.name));
  if (!model.invariants.empty()) diagnostics_.add(errors::process_beside_constraints(tree_.subject.span, model.name));
  auto const ruled = with_prediction(model, task.prediction);
  if (ruled && feeds_back(*ruled))
    diagnostics_.add(errors::process_feeds_back(
        tree_.subject.span, task.prediction == PredictionRule::free_run ? "of a free run" : "that the model simulates"));
}

}  // namespace sysid
