// `select`: the candidates, what each is fitted to, the back end that selects, and the distance.
#include <algorithm>

#include "check/message/errors.hpp"
#include "check/message/errors_reuse.hpp"
#include "check/task/select_options.hpp"
#include "check/task/task_checker.hpp"
#include "check/task/task_options.hpp"

namespace sysid {

std::optional<int> TaskChecker::candidate_set() {
  ast::Name const& name = tree_.subject;
  if (names_.candidates.contains(name.text)) {
    for (ast::Argument const& argument : tree_.arguments)
      diagnostics_.add(errors::arguments_of_candidates(argument.span, name.text));
    return item(name, names_.candidates, "set of candidates");
  }
  if (!names_.models.contains(name.text)) {
    std::vector<std::string> known;
    for (auto const& [each, index] : names_.candidates) known.push_back(each);
    for (auto const& [each, index] : names_.models) known.push_back(each);
    diagnostics_.add(errors::unknown_item(name, "set of candidates", known));
    return std::nullopt;
  }
  auto const model = item(name, names_.models, "model");
  if (!model) return std::nullopt;
  file_.candidates.push_back(
      {name.text, file_.models[static_cast<std::size_t>(*model)].title, name.span, {{*model, 1, name.span, name.text}}, {}});
  return static_cast<int>(file_.candidates.size()) - 1;
}

std::vector<std::string> TaskChecker::common_channels(CandidateSet const& set, std::vector<ExperimentUse> const& experiments) {
  auto const model_of = [&](CandidateModel const& candidate) -> Model const& {
    return file_.models[static_cast<std::size_t>(candidate.model)];
  };
  auto const find = [](Model const& model, std::string const& name) -> Channel const* {
    auto const place =
        std::find_if(model.channels.begin(), model.channels.end(), [&](Channel const& each) { return each.name == name; });
    return place == model.channels.end() ? nullptr : &*place;
  };
  auto const is_measured = [&](std::string const& channel) {
    return std::any_of(experiments.begin(), experiments.end(), [&](ExperimentUse const& use) {
      auto const& all = file_.data[static_cast<std::size_t>(use.data)].measured;
      return std::any_of(all.begin(), all.end(), [&](DataMeasureUse const& each) { return each.channel == channel; });
    });
  };
  std::vector<std::string> channels;
  for (CandidateModel const& one : set.models)
    for (Channel const& channel : model_of(one).channels) {
      if (!is_measured(channel.name) || std::find(channels.begin(), channels.end(), channel.name) != channels.end()) continue;
      channels.push_back(channel.name);
      for (CandidateModel const& other : set.models) {
        Channel const* same = find(model_of(other), channel.name);
        if (same == nullptr)
          diagnostics_.add(errors::candidate_without_channel(other.span, other.name, channel.span, one.name, channel.name));
        else if (same->unit && channel.unit &&
                 (same->unit->dimension != channel.unit->dimension || zero_against_difference(*same->unit, *channel.unit)))
          diagnostics_.add(errors::channel_of_two_units(same->span, other.name, *same->unit, channel.span, one.name, *channel.unit,
                                                        channel.name));
        else
          continue;
        break;
      }
    }
  return channels;
}

std::vector<FitTask> TaskChecker::candidate_fits(CandidateSet const& set, FitTask const& common) {
  std::vector<FitTask> fits;
  for (CandidateModel const& candidate : set.models) {
    Model const& model = file_.models[static_cast<std::size_t>(candidate.model)];
    if (!model.processes.empty()) diagnostics_.add(errors::process_task(tree_.subject.span, "a candidate of `select`", model.name));
    if (model.channels.empty()) {
      diagnostics_.add(errors::nothing_observed({{candidate.span}, candidate.name}));
      return {};
    }
    FitTask fit = common;
    fit.model = candidate.model;
    fit.experiments = experiments(&model, "to");
    suit(fit, model);
    // What is wrong with the data is wrong for the next candidate, too.
    if (diagnostics_.has_errors(before_)) return {};
    fits.push_back(std::move(fit));
  }
  return fits;
}

SelectTask TaskChecker::select() {
  SelectTask task;
  auto const index = candidate_set();
  std::vector<int> models;
  if (index) {
    task.candidates = *index;
    for (CandidateModel const& each : file_.candidates[static_cast<std::size_t>(*index)].models) models.push_back(each.model);
  }
  FitTask common;
  SelectOptions own{options_, task};
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    if (simulation_option(option, key, models, common)) continue;
    if (SelectOptionRow const* const row = find_select_option(option)) {
      if (options_.fresh(option, key)) row->read(option, own);
    } else if (!backend_option(option, key, backends_.selecting, task.backend, task.settings)) {
      options_.unknown(option, task_option_names("select"));
    }
  }
  task.seed = common.seed;
  if (task.backend.empty() && !diagnostics_.has_errors(before_))
    diagnostics_.add(errors::backend_missing(tree_, names_of(backends_.selecting)));
  if (!index) {
    experiments(nullptr, "to");
    return task;
  }
  CandidateSet const set = file_.candidates[static_cast<std::size_t>(*index)];
  task.fits = candidate_fits(set, common);
  if (!diagnostics_.has_errors(before_)) report_needless_filter(common.filter);
  suit_distances(task);
  if (!task.fits.empty()) report_needless_solver();
  if (task.fits.empty()) return task;
  auto channels = common_channels(set, task.fits.front().experiments);
  if (!diagnostics_.has_errors(before_))
    task.distance = check_distance(own.distance, std::move(channels), set, file_, options_, diagnostics_);
  return task;
}

}  // namespace sysid
