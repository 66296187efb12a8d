// Tasks: which verb it is, and what several verbs share.
#include "check/tasks.hpp"

#include "check/errors.hpp"
#include "check/task_checker.hpp"

namespace sysid {

TaskChecker::TaskChecker(ast::Task const& tree, TaskNames const& names, CheckedFile const& file,
                         std::span<BackendSettings const> backends, std::span<ast::Task const* const> all_tasks,
                         Diagnostics& diagnostics)
    : tree_(tree),
      names_(names),
      file_(file),
      backends_(backends),
      all_tasks_(all_tasks),
      diagnostics_(diagnostics),
      before_(diagnostics.all().size()),
      options_(tree.verb.text, diagnostics) {}

std::optional<Task> TaskChecker::run() {
  Task task;
  task.name = task_name(tree_);
  task.span = tree_.verb.span;
  if (tree_.verb.text == "simulate") {
    task.what = simulate();
  } else if (tree_.verb.text == "fit") {
    task.what = fit();
  } else {
    task.what = predict();
  }
  bool const errors = diagnostics_.has_errors(before_);
  if (errors || unresolved_) return std::nullopt;
  return task;
}

std::optional<int> TaskChecker::item(ast::Name const& name, std::map<std::string, std::optional<int>> const& items,
                                     std::string const& kind) {
  auto const place = items.find(name.text);
  if (place == items.end()) {
    std::vector<std::string> known;
    for (auto const& [each, index] : items) known.push_back(each);
    diagnostics_.add(errors::unknown_item(name, kind, known));
    return std::nullopt;
  }
  if (!place->second) unresolved_ = true;
  return place->second;
}

void TaskChecker::suit(SolverSettings& solver, Model const& model) {
  if (!model.implicit) return;
  if (!options_.solver_span())
    solver = {.method = "ida"};
  else if (solver.row().stepping != Stepping::ida)
    diagnostics_.add(
        errors::explicit_solver(*options_.solver_span(), solver.method, model.implicit->equation, model.implicit->unknown));
}

void TaskChecker::suit(StartRule const& start, Model const& model, std::vector<ast::Option> const& options) {
  if (start.kind != StartRule::Kind::estimated || model.invariants.empty()) return;
  for (ast::Option const& option : options)
    if (key_of(option) == "start")
      diagnostics_.add(errors::estimated_start_of_constraint(option.span, model.invariants.front().span));
}

void TaskChecker::prediction(ast::Option const& option, Model const* model, PredictionRule& rule) {
  std::vector<std::string> names;
  std::optional<PredictionRule> chosen;
  for (PredictionRule const each : {PredictionRule::as_written, PredictionRule::one_step, PredictionRule::free_run}) {
    names.emplace_back(prediction_name(each));
    if (as_word(option.value) == names.back()) chosen = each;
  }
  if (!chosen) {
    diagnostics_.add(errors::option_choice(option.value.span, "prediction", as_word(option.value).value_or(""), names));
    return;
  }
  if (model == nullptr || *chosen == PredictionRule::as_written) return;
  if (model->dynamics != Dynamics::discrete)
    diagnostics_.add(errors::prediction_without_lags(option.span, model->name));
  else if (!with_prediction(*model, *chosen))
    diagnostics_.add(errors::nothing_measured_to_predict_from(option.span, model->name));
  rule = *chosen;
}

std::string task_name(ast::Task const& tree) { return tree.name ? tree.name->text : tree.verb.text + "_" + tree.subject.text; }

std::optional<Task> check_task(ast::Task const& tree, TaskNames const& names, CheckedFile const& file,
                               std::span<BackendSettings const> backends, std::span<ast::Task const* const> all_tasks,
                               Diagnostics& diagnostics) {
  return TaskChecker(tree, names, file, backends, all_tasks, diagnostics).run();
}

}  // namespace sysid
