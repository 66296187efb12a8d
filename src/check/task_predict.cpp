// `predict`: the fit whose draws it uses, and how.
#include "check/task_checker.hpp"

#include <algorithm>

#include "check/errors.hpp"

namespace sysid {

PredictTask TaskChecker::predict() {
  PredictTask task;
  auto const fit =
      std::find_if(file_.tasks.begin(), file_.tasks.end(), [&](Task const& each) { return each.name == tree_.subject.text; });
  Model const* model = nullptr;
  if (fit == file_.tasks.end()) {
    std::vector<std::string> known;
    bool exists = false;
    for (ast::Task const* each : all_tasks_) {
      if (each->verb.text == "fit") known.push_back(task_name(*each));
      if (each != &tree_ && task_name(*each) == tree_.subject.text) exists = true;
    }
    bool const later = exists && std::find_if(all_tasks_.begin(), all_tasks_.end(), [&](ast::Task const* each) {
                                   return task_name(*each) == tree_.subject.text;
                                 }) > std::find(all_tasks_.begin(), all_tasks_.end(), &tree_);
    if (!exists)
      diagnostics_.add(errors::unknown_item(tree_.subject, "fit", known));
    else if (later)
      diagnostics_.add(errors::task_too_late(tree_.subject));
    else
      unresolved_ = true;  // it failed its own check
  } else if (auto const* what = std::get_if<FitTask>(&fit->what)) {
    task.fit = static_cast<int>(fit - file_.tasks.begin());
    model = &file_.models[static_cast<std::size_t>(what->model)];
  } else {
    diagnostics_.add(errors::not_a_fit(tree_.subject));
  }
  task.experiments = experiments(model, "on");
  for (ExperimentUse const& use : task.experiments) {
    task.fitted.push_back(-1);
    if (model == nullptr) continue;
    std::vector<ExperimentUse> const& fitted = std::get<FitTask>(fit->what).experiments;
    bool const split = std::count_if(fitted.begin(), fitted.end(), [&](auto const& each) { return each.data == use.data; }) > 1;
    for (std::size_t e = 0; e < fitted.size(); ++e)
      if (fitted[e].data == use.data && (!split || fitted[e].part == use.part)) task.fitted.back() = static_cast<int>(e);
  }
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    if (option.input || !options_.fresh(option, key)) {
      if (option.input) options_.unknown(option, {"draws", "redraw", "start", "prediction", "seed"});
      continue;
    }
    if (key == "draws") {
      ast::Call const* call = as_call(option.value);
      ast::Expression const* count = option.key ? &option.value
                                     : call != nullptr && call->arguments.size() == 1 && !call->arguments[0].name
                                         ? &call->arguments[0].value
                                         : nullptr;
      if (count == nullptr)
        diagnostics_.add(errors::option_kind(option.span, "draws", "a number of posterior draws", "draws(200)"));
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
      prediction(option, model, task.prediction);
    } else if (option.key && key == "seed") {
      options_.seed(option, task.seed);
    } else {
      options_.unknown(option, {"draws", "redraw", "start", "prediction", "seed"});
    }
  }
  if (model != nullptr) suit(task.start, *model, tree_.options);
  return task;
}

}  // namespace sysid
