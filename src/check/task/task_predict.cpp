// `predict`: the fit or selection whose draws it uses, and how.
#include "check/task/task_checker.hpp"
#include "check/task/task_options.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/checked/task_kinds.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"
#include "core/setting/table.hpp"

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
    if (each != &tree_ && fits(*find_task_kind(each->verb.text))) known.push_back(task_name(*each));
  auto const self = std::find(all_tasks_.begin(), all_tasks_.end(), &tree_);
  auto const written = std::find_if(all_tasks_.begin(), all_tasks_.end(),
                                    [&](ast::Task const* each) { return each != &tree_ && task_name(*each) == name; });
  if (written == all_tasks_.end())
    diagnostics_.add(errors::unknown_fit(subject, known, names_.data.contains(name)));
  else if (written > self)
    diagnostics_.add(errors::task_too_late(subject));
  else
    unresolved_ = true;  // it failed its own check
  return std::nullopt;
}

std::vector<FitTask const*> TaskChecker::predicted_fits(PredictTask& task) {
  std::vector<FitTask const*> fits;
  std::vector<ast::Name> names = {tree_.subject};
  names.insert(names.end(), tree_.others.begin(), tree_.others.end());
  bool complete = true;
  for (std::size_t k = 0; k < names.size(); ++k) {
    auto const same = std::find_if(names.begin(), names.begin() + static_cast<std::ptrdiff_t>(k),
                                   [&](ast::Name const& each) { return each.text == names[k].text; });
    if (same != names.begin() + static_cast<std::ptrdiff_t>(k)) {
      diagnostics_.add(errors::averaged_twice(names[k], same->span));
      complete = false;
      continue;
    }
    auto const found = fitted_task(names[k], true);
    complete = complete && found;
    if (!found) continue;
    Task const& subject = file_.tasks[static_cast<std::size_t>(*found)];
    auto const* selection = std::get_if<SelectTask>(&subject.what);
    if (selection != nullptr && names.size() > 1) {
      diagnostics_.add(errors::selection_in_average(names[k]));
      complete = false;
      continue;
    }
    if (k == 0) task.fit = *found;
    if (names.size() > 1) task.members.emplace_back().fit = *found;
    if (selection != nullptr)
      for (FitTask const& each : selection->fits) fits.push_back(&each);
    else
      fits.push_back(&std::get<FitTask>(subject.what));
  }
  return complete ? fits : std::vector<FitTask const*>();
}

namespace {

// Of each use the experiment of the fit whose parameters it has; -1: a new one.
std::vector<int> fitted_parts(std::vector<ExperimentUse> const& uses, std::vector<ExperimentUse> const& fitted) {
  std::vector<int> parts;
  for (ExperimentUse const& use : uses) {
    parts.push_back(-1);
    bool const split = std::count_if(fitted.begin(), fitted.end(), [&](auto const& each) { return each.data == use.data; }) > 1;
    for (std::size_t e = 0; e < fitted.size(); ++e)
      if (fitted[e].data == use.data && (!split || fitted[e].part == use.part)) parts.back() = static_cast<int>(e);
  }
  return parts;
}

}  // namespace

PredictTask TaskChecker::predict() {
  PredictTask task;
  std::vector<FitTask const*> const fits = predicted_fits(task);
  std::vector<int> models;
  for (FitTask const* each : fits) models.push_back(each->model);
  if (fits.empty()) experiments(nullptr, "on");
  std::vector<std::vector<ExperimentUse>> uses;
  for (std::size_t c = 0; c < fits.size() && !diagnostics_.has_errors(before_); ++c)
    uses.push_back(experiments(&file_.models[static_cast<std::size_t>(models[c])], "on"));
  if (!uses.empty()) task.experiments = uses.front();
  if (!fits.empty()) task.fitted = fitted_parts(task.experiments, fits.front()->experiments);
  std::vector<int> corrected;
  for (std::size_t c = 0; c < uses.size() && !diagnostics_.has_errors(before_); ++c) {
    std::vector<double> errors = predicted_input_errors(*fits[c], uses[c]);
    if (!errors.empty() || file_.models[static_cast<std::size_t>(models[c])].filtered()) corrected.push_back(models[c]);
    if (c == 0) task.input_errors = errors;
    task.candidate_input_errors.push_back(std::move(errors));
  }
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    if (!option.input && options_.fresh(option, key))
      predict_option(option, key, models, corrected, task);
    else if (option.input)
      options_.unknown(option, task_option_names("predict"));
  }
  if (task.redraw_each_step && !corrected.empty())
    for (ast::Option const& option : tree_.options)
      if (key_of(option) == "redraw")
        diagnostics_.add(errors::disturbance_beside(option.span, {"a prediction of random states"}, errors::named("redraw"),
                                                    "remove the option: each trajectory then has one draw of the parameters"));
  for (int const m : models) {
    Model const& model = file_.models[static_cast<std::size_t>(m)];
    suit(task.start, model, tree_.options);
    if (model.processes.empty()) continue;
    if (model.integrated() && task.start.kind == StartRule::Kind::estimated)
      diagnostics_.add(errors::process_beside_estimated_start(tree_.subject.span, model.name));
    if (task.redraw_each_step)
      diagnostics_.add(errors::process_task(tree_.subject.span, "predicted with parameters redrawn at each step", model.name));
    if (task.averages()) diagnostics_.add(errors::process_task(tree_.subject.span, "averaged with other fits", model.name));
  }
  suit_forecast(fits, task);
  if (task.averages())
    average(fits, uses, task);
  else if (!fits.empty() && kind_of(file_.tasks[static_cast<std::size_t>(task.fit)]) == TaskKind::select)
    task.candidate_experiments = std::move(uses);
  return task;
}

void TaskChecker::draws(ast::Option const& option, int& count) {
  ast::Call const* call = as_call(option.value);
  ast::Expression const* given = option.key ? &option.value
                                 : call != nullptr && call->arguments.size() == 1 && !call->arguments[0].name
                                     ? &call->arguments[0].value
                                     : nullptr;
  if (given == nullptr)
    diagnostics_.add(errors::option_kind(option.span, "draws", {"a number of posterior draws"}, "draws(200)"));
  else if (auto const value = options_.number(*given, "draws", Unit{}, 1, 1e7, true))
    count = static_cast<int>(*value);
}

void TaskChecker::predict_option(ast::Option const& option, std::string const& key, std::span<int const> models,
                                 std::span<int const> corrected, PredictTask& task) {
  std::string const word = as_word(option.value).value_or("");
  if (key == "draws") {
    draws(option, task.draws);
  } else if (option.key && key == "weights") {
    if (tree_.others.empty())
      diagnostics_.add(errors::weights_of_one_fit(option.span, tree_.subject.text));
    else if (auto const weights = average_weights(word))
      task.weights = *weights;
    else
      diagnostics_.add(errors::option_choice(option.value.span, key, word, average_weights_words()));
  } else if (option.key && key == "redraw") {
    if (word != "trajectory" && word != "step")
      diagnostics_.add(errors::option_choice(option.value.span, key, word, {"trajectory", "step"}));
    else if (word == "step" && !tree_.others.empty())
      diagnostics_.add(errors::average_redrawn(option.span));
    else
      task.redraw_each_step = word == "step";
  } else if (option.key && key == "start") {
    options_.start(option, task.start);
  } else if (option.key && key == "prediction" && as_call(option.value) != nullptr) {
    steps_ahead(option, models, corrected, task);
  } else if (option.key && key == "prediction") {
    prediction(option, models, task.prediction, corrected);
  } else if (option.key && key == "seed") {
    options_.seed(option, task.seed);
  } else {
    options_.unknown(option, task_option_names("predict"));
  }
}

void TaskChecker::steps_ahead(ast::Option const& option, std::span<int const> models, std::span<int const> corrected,
                              PredictTask& task) {
  ast::Call const& call = *as_call(option.value);
  if (call.function.text != "steps" || call.arguments.size() != 1 || call.arguments[0].name)
    return diagnostics_.add(
        errors::option_kind(option.span, "prediction", {"a rule, or a number of rows ahead"}, "prediction = steps(10)"));
  auto const rows = options_.number(call.arguments[0].value, "steps", Unit{}, 1, 1e6, true, OptionReader::time_for_rows());
  if (!rows || models.empty()) return;
  if (models.size() != 1 || !tree_.others.empty()) return diagnostics_.add(errors::steps_ahead_of_several(option.span));
  if (corrected.empty())
    return diagnostics_.add(errors::steps_ahead_of_known(option.span, file_.models[static_cast<std::size_t>(models[0])].name));
  task.prediction = PredictionRule::one_step;
  task.ahead = static_cast<int>(*rows);
}

void TaskChecker::average(std::vector<FitTask const*> const& fits, std::vector<std::vector<ExperimentUse>> const& uses,
                          PredictTask& task) {
  if (diagnostics_.has_errors(before_) || unresolved_) return;
  suit_average(fits, task);
  for (std::size_t k = 0; k < task.members.size(); ++k) {
    PredictTask member = task;
    member.members.clear();
    member.fit = task.members[k].fit;
    member.experiments = uses[k];
    member.fitted = fitted_parts(uses[k], fits[k]->experiments);
    member.input_errors = task.candidate_input_errors[k];
    task.members[k] = std::move(member);
  }
}

void TaskChecker::suit_average(std::vector<FitTask const*> const& fits, PredictTask const& task) {
  auto const name = [&](std::size_t k) -> ast::Name const& { return k == 0 ? tree_.subject : tree_.others[k - 1]; };
  std::string const others = "or write `weights = equal`, which needs neither evidences nor scores";
  for (std::size_t k = 0; k < fits.size() && task.weights != AverageWeights::equal; ++k) {
    BackendSettings const* const backend = row_named(backends_.fitting, fits[k]->backend);
    bool const by_evidence = task.weights == AverageWeights::evidence, optimum = backend != nullptr && backend->optimum;
    if (by_evidence && optimum && !backend->prior)
      diagnostics_.add(errors::fit_without_weight(name(k), fits[k]->backend, fmt::format("`{}` has no evidence", backend->name),
                                                  "fit it with a back end that uses the prior; " + others));
    else if (by_evidence && fits[k]->evidence == EvidenceMethod::none)
      diagnostics_.add(errors::fit_without_weight(name(k), fits[k]->backend, "its fit has `evidence = none`",
                                                  "remove that option from the fit; write `weights = stacking`; " + others));
    else if (!by_evidence && optimum)
      diagnostics_.add(errors::fit_without_weight(
          name(k), fits[k]->backend, fmt::format("`{}` has no posterior draws, and so no predictive scores", backend->name),
          "fit it with `mh` or `nuts`; " + others));
  }
  for (ExperimentUse const& use : task.experiments) suit_channels(fits, file_.data[static_cast<std::size_t>(use.data)]);
}

void TaskChecker::suit_channels(std::vector<FitTask const*> const& fits, DataBlock const& block) {
  auto const name = [&](std::size_t k) -> ast::Name const& { return k == 0 ? tree_.subject : tree_.others[k - 1]; };
  for (DataMeasureUse const& measured : block.measured) {
    auto const channel = [&](std::size_t k) -> Channel const* {
      auto const& channels = file_.models[static_cast<std::size_t>(fits[k]->model)].channels;
      auto const found =
          std::find_if(channels.begin(), channels.end(), [&](Channel const& each) { return each.name == measured.channel; });
      return found == channels.end() ? nullptr : &*found;
    };
    std::size_t first = 0;
    while (first < fits.size() && channel(first) == nullptr) ++first;
    for (std::size_t k = 0; k < fits.size() && first < fits.size(); ++k) {
      Channel const *own = channel(k), *other = channel(first);
      if (own == nullptr)
        diagnostics_.add(errors::average_without_channel(name(k), measured.channel, name(first).text, block.name));
      else if (Unit const of_own = own->unit.value_or(Unit{}), of_other = other->unit.value_or(Unit{});
               of_own.dimension != of_other.dimension || zero_against_difference(of_own, of_other))
        diagnostics_.add(errors::average_of_two_units(name(k), of_own, measured.channel, name(first).text, of_other));
    }
  }
}

}  // namespace sysid
