// `predict`: the fit or selection whose draws it uses, and how.
#include "check/task/task_checker.hpp"
#include "check/task/task_options.hpp"

#include <algorithm>

#include "check/checked/task_kinds.hpp"
#include "check/message/errors.hpp"

namespace sysid {

std::optional<int> TaskChecker::fitted_task(ast::Name const& subject, bool or_selection) {
  std::string const& name = subject.text;
  auto const fits = [&](TaskKindRow const& row) { return row.has_draws && (or_selection || row.kind == TaskKind::fit); };
  auto const fit = std::find_if(file_.tasks.begin(), file_.tasks.end(), [&](Task const& each) { return each.name == name; });
  if (fit != file_.tasks.end()) {
    if (fits(row_of(kind_of(*fit)))) return static_cast<int>(fit - file_.tasks.begin());
    diagnostics_.add(errors::not_a_fit(subject, tree_.verb.text));
    return std::nullopt;
  }
  std::vector<std::string> known;
  for (ast::Task const* each : all_tasks_)
    if (fits(*find_task_kind(each->verb.text))) known.push_back(task_name(*each));
  auto const self = std::find(all_tasks_.begin(), all_tasks_.end(), &tree_);
  auto const written = std::find_if(all_tasks_.begin(), all_tasks_.end(),
                                    [&](ast::Task const* each) { return each != &tree_ && task_name(*each) == name; });
  if (written == all_tasks_.end())
    diagnostics_.add(errors::unknown_fit(subject, known));
  else if (written > self)
    diagnostics_.add(errors::task_too_late(subject));
  else
    unresolved_ = true;  // it failed its own check
  return std::nullopt;
}

PredictTask TaskChecker::predict() {
  PredictTask task;
  std::vector<FitTask const*> fits;  // of a selection one per candidate
  if (auto const fit = fitted_task(tree_.subject, true)) {
    task.fit = *fit;
    Task const& subject = file_.tasks[static_cast<std::size_t>(*fit)];
    if (auto const* selection = std::get_if<SelectTask>(&subject.what))
      for (FitTask const& each : selection->fits) fits.push_back(&each);
    else
      fits.push_back(&std::get<FitTask>(subject.what));
  }
  std::vector<int> models;
  for (FitTask const* each : fits) models.push_back(each->model);
  if (fits.empty()) experiments(nullptr, "on");
  for (std::size_t c = 0; c < fits.size() && !diagnostics_.has_errors(before_); ++c) {
    auto uses = experiments(&file_.models[static_cast<std::size_t>(models[c])], "on");
    if (c == 0) task.experiments = uses;
    if (kind_of(file_.tasks[static_cast<std::size_t>(task.fit)]) == TaskKind::select)
      task.candidate_experiments.push_back(std::move(uses));
  }
  for (ExperimentUse const& use : task.experiments) {
    task.fitted.push_back(-1);
    std::vector<ExperimentUse> const& fitted = fits.front()->experiments;
    bool const split = std::count_if(fitted.begin(), fitted.end(), [&](auto const& each) { return each.data == use.data; }) > 1;
    for (std::size_t e = 0; e < fitted.size(); ++e)
      if (fitted[e].data == use.data && (!split || fitted[e].part == use.part)) task.fitted.back() = static_cast<int>(e);
  }
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    if (option.input || !options_.fresh(option, key)) {
      if (option.input) options_.unknown(option, task_option_names("predict"));
      continue;
    }
    if (key == "draws") {
      ast::Call const* call = as_call(option.value);
      ast::Expression const* count = option.key ? &option.value
                                     : call != nullptr && call->arguments.size() == 1 && !call->arguments[0].name
                                         ? &call->arguments[0].value
                                         : nullptr;
      if (count == nullptr)
        diagnostics_.add(errors::option_kind(option.span, "draws", {"a number of posterior draws"}, "draws(200)"));
      else if (auto const value = options_.number(*count, "draws", Unit{}, 1, 1e7, true))
        task.draws = static_cast<int>(*value);
    } else if (option.key && key == "redraw") {
      auto const word = as_word(option.value);
      if (word == "trajectory" || word == "step")
        task.redraw_each_step = word == "step";
      else
        diagnostics_.add(errors::option_choice(option.value.span, key, word.value_or(""), {"trajectory", "step"}));
    } else if (option.key && key == "start") {
      options_.start(option, task.start);
    } else if (option.key && key == "prediction") {
      prediction(option, models, task.prediction);
    } else if (option.key && key == "seed") {
      options_.seed(option, task.seed);
    } else {
      options_.unknown(option, task_option_names("predict"));
    }
  }
  for (int const m : models) {
    Model const& model = file_.models[static_cast<std::size_t>(m)];
    suit(task.start, model, tree_.options);
    if (model.processes.empty()) continue;
    if (model.integrated() && task.start.kind == StartRule::Kind::estimated)
      diagnostics_.add(errors::process_beside_estimated_start(tree_.subject.span, model.name));
    if (task.redraw_each_step)
      diagnostics_.add(errors::process_task(tree_.subject.span, "predicted with parameters redrawn at each step", model.name));
  }
  return task;
}

}  // namespace sysid
