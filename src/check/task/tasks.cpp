// Tasks: which verb it is, and what several verbs share.
#include "check/task/tasks.hpp"

#include <algorithm>

#include "check/checked/task_kinds.hpp"
#include "check/expression/leaves.hpp"
#include "check/message/errors.hpp"
#include "check/task/task_checker.hpp"
#include "check/task/task_options.hpp"
#include "core/setting/table.hpp"
#include "solver/linear_structure.hpp"

namespace sysid {

TaskChecker::TaskChecker(ast::Task const& tree, TaskNames const& names, CheckedFile& file, Backends const& backends,
                         std::span<ast::Task const* const> all_tasks, Diagnostics& diagnostics)
    : tree_(tree),
      names_(names),
      file_(file),
      backends_(backends),
      all_tasks_(all_tasks),
      diagnostics_(diagnostics),
      before_(diagnostics.all().size()),
      options_(tree.verb.text, diagnostics, &verbs_with_option) {}

std::optional<Task> TaskChecker::run() {
  Task task;
  task.name = task_name(tree_);
  task.span = tree_.verb.span;
  struct Row {
    TaskKind kind;
    decltype(Task::what) (*check)(TaskChecker&);
  };
  static constexpr Row rows[] = {
      {TaskKind::simulate, [](TaskChecker& checker) -> decltype(Task::what) { return checker.simulate(); }},
      {TaskKind::fit, [](TaskChecker& checker) -> decltype(Task::what) { return checker.fit(); }},
      {TaskKind::select, [](TaskChecker& checker) -> decltype(Task::what) { return checker.select(); }},
      {TaskKind::discover, [](TaskChecker& checker) -> decltype(Task::what) { return checker.discover(); }},
      {TaskKind::predict, [](TaskChecker& checker) -> decltype(Task::what) { return checker.predict(); }},
  };
  static_assert(std::size(rows) == task_kind_count);
  task.what = row_for(rows, find_task_kind(tree_.verb.text)->kind).check(*this);
  bool const errors = diagnostics_.has_errors(before_);
  if (errors || unresolved_) return std::nullopt;
  return task;
}

void TaskChecker::explain_subject(Diagnostic& unknown) const {
  std::string const& name = tree_.subject.text;
  char const* verb = nullptr;
  char const* kind = nullptr;
  if (names_.dictionaries.contains(name)) verb = "discover", kind = "dictionary";
  if (names_.candidates.contains(name)) verb = "select", kind = "set of candidates";
  if (names_.models.contains(name) && tree_.verb.text != "discover") verb = "fit", kind = "model";
  if (verb != nullptr) unknown.help = errors::verb_of_subject(tree_, kind, verb);
}

std::optional<int> TaskChecker::item(ast::Name const& name, std::map<std::string, std::optional<int>> const& items,
                                     std::string const& kind) {
  auto const place = items.find(name.text);
  if (place == items.end()) {
    std::vector<std::string> known;
    for (auto const& [each, index] : items) known.push_back(each);
    Diagnostic unknown = errors::unknown_item(name, kind, known);
    if (&name == &tree_.subject) explain_subject(unknown);
    diagnostics_.add(std::move(unknown));
    return std::nullopt;
  }
  if (!place->second) unresolved_ = true;
  return place->second;
}

void TaskChecker::suit_exact(SolverSettings const& solver, Model const& model) {
  if (!model.integrated() || !solver.row().exact) return;
  Span const option = *options_.solver_span();
  std::vector<NodeId> derivatives;
  for (State const& state : model.states) derivatives.push_back(state.derivative);
  auto const found = find_nonlinear(model.graph, derivatives);
  if (found && found->why == NotLinear::Why::time)
    diagnostics_.add(errors::solver_that_reads_no_time(option, solver.method, model.name));
  else if (found)
    diagnostics_.add(errors::solver_of_linear_equations(option, solver.method, place_of(model.graph, found->node),
                                                        found->why == NotLinear::Why::varies));
  else if (std::ssize(model.states) > most_exact_states)
    diagnostics_.add(errors::solver_of_few_states(option, solver.method, model.name, model.states.size(), most_exact_states));
}

void TaskChecker::report_needless_solver() {
  if (options_.solver_span() && !solver_needed_ && !diagnostics_.has_errors(before_))
    diagnostics_.add(errors::solver_of_nothing(*options_.solver_span(), tree_.subject.text));
}

void TaskChecker::suit(SolverSettings& solver, Model const& model) {
  solver_needed_ = solver_needed_ || model.integrated() || model.implicit;
  if (!model.implicit) return suit_exact(solver, model);
  if (!options_.solver_span())
    solver = {.method = std::string(implicit_solver().name)};
  else if (!solver.row().implicit)
    diagnostics_.add(
        errors::explicit_solver(*options_.solver_span(), solver.method, model.implicit->equation, model.implicit->unknown));
}

void TaskChecker::suit(StartRule const& start, Model const& model, std::vector<ast::Option> const& options) {
  if (start.kind != StartRule::Kind::estimated || model.invariants.empty()) return;
  for (ast::Option const& option : options)
    if (key_of(option) == "start")
      diagnostics_.add(errors::estimated_start_of_constraint(option.span, model.invariants.front().span));
}

bool TaskChecker::simulation_option(ast::Option const& option, std::string const& key, std::span<int const> models, FitTask& task) {
  if (option.input || !option.key) return false;
  if (key != "start" && key != "substeps" && key != "solver" && key != "prediction" && key != "filter" && key != "seed")
    return false;
  if (!options_.fresh(option, key)) return true;
  if (key == "start")
    options_.start(option, task.start);
  else if (key == "prediction")
    prediction(option, models, task.prediction);
  else if (key == "filter")
    filter(option, task.filter);
  else if (key == "seed")
    options_.seed(option, task.seed);
  else {
    task.solver_stated = true;
    task.refine_solver = !options_.solver(option, task.solver);
  }
  return true;
}

void TaskChecker::each_named(ast::Call const& call, errors::Subject const& owner, std::string const& member,
                             std::vector<std::string> const& known,
                             std::function<void(ast::Argument const&, std::size_t)> const& visit) {
  std::map<std::string, Span> given;
  for (ast::Argument const& argument : call.arguments) {
    if (!argument.name) {
      diagnostics_.add(errors::must_be_named(call, argument, known));
      continue;
    }
    auto const place = std::find(known.begin(), known.end(), argument.name->text);
    if (place == known.end()) {
      diagnostics_.add(errors::unknown_member(*argument.name, owner, member, known));
      continue;
    }
    if (auto const [first, is_fresh] = given.emplace(argument.name->text, argument.span); !is_fresh)
      diagnostics_.add(errors::stated_twice(argument.span, first->second, errors::named(argument.name->text)));
    else
      visit(argument, static_cast<std::size_t>(place - known.begin()));
  }
}

bool TaskChecker::backend_option(ast::Option const& option, std::string const& key, std::span<BackendSettings const> known,
                                 std::string& backend, Settings& settings) {
  if (option.input || option.key || key.empty()) return false;
  BackendSettings const* const row = row_named(known, key);
  if (row == nullptr) {
    auto const among = [&](std::span<BackendSettings const> rows) { return row_named(rows, key) != nullptr; };
    std::optional<TaskKind> own;
    if (among(backends_.discovering)) own = TaskKind::discover;
    if (among(backends_.selecting)) own = TaskKind::select;
    if (among(backends_.fitting)) own = TaskKind::fit;
    diagnostics_.add(own ? errors::backend_of_other_verb({{head_span(option.value)}, key}, tree_.verb.text, *own, names_of(known))
                         : errors::unknown_backend({{head_span(option.value)}, key}, names_of(known)));
    backend = key;  // said once is enough
    return true;
  }
  if (!options_.fresh_backend(option)) return true;
  backend = key;
  settings = Settings(row->settings);
  if (ast::Call const* call = as_call(option.value)) options_.settings(*call, row->settings, settings);
  return true;
}

void TaskChecker::suit(FitTask& task, Model const& model) {
  suit(task.solver, model);
  suit(task.start, model, tree_.options);
  suit_filter(task, model);
  if (model.integrated()) return;  // else there is nothing to solve
  task.solver = {};
  task.refine_solver = false;
}

void TaskChecker::prediction(ast::Option const& option, std::span<int const> models, PredictionRule& rule,
                             std::span<int const> corrected) {
  std::vector<std::string> names;
  std::optional<PredictionRule> chosen;
  for (PredictionRule const each : {PredictionRule::as_written, PredictionRule::one_step, PredictionRule::free_run}) {
    names.emplace_back(prediction_name(each));
    if (as_word(option.value) == names.back()) chosen = each;
  }
  if (!chosen) {
    if (words::task_kind(tree_.verb.text) == TaskKind::predict) names.emplace_back("steps(10)");
    diagnostics_.add(errors::option_choice(option.value.span, "prediction", as_word(option.value).value_or(""), names));
    return;
  }
  rule = *chosen;
  if (rule == PredictionRule::as_written) return;
  for (int const index : models) {
    if (std::find(corrected.begin(), corrected.end(), index) != corrected.end()) continue;
    Model const& model = file_.models[static_cast<std::size_t>(index)];
    // Beside models that are corrected, one that is not runs freely.
    if (model.dynamics != Dynamics::discrete && !corrected.empty()) continue;
    if (model.dynamics != Dynamics::discrete)
      return diagnostics_.add(errors::prediction_without_lags(option.span, model.name, model.filtered()));
    if (!with_prediction(model, rule)) return diagnostics_.add(errors::nothing_measured_to_predict_from(option.span, model.name));
  }
}

std::vector<std::string> names_of(std::span<BackendSettings const> backends) {
  std::vector<std::string> names;
  for (BackendSettings const& backend : backends) names.emplace_back(backend.name);
  return names;
}

std::string task_name(ast::Task const& tree) { return tree.called(); }

std::optional<Task> check_task(ast::Task const& tree, TaskNames const& names, CheckedFile& file, Backends const& backends,
                               std::span<ast::Task const* const> all_tasks, Diagnostics& diagnostics) {
  return TaskChecker(tree, names, file, backends, all_tasks, diagnostics).run();
}

}  // namespace sysid
