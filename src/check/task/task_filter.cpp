// How the likelihood of random states is computed, and the errors of inputs, which make states random.
#include <fmt/format.h>

#include <algorithm>

#include "check/expression/leaves.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"
#include "check/task/task_checker.hpp"
#include "check/task/task_options.hpp"
#include "check/units/units.hpp"
#include "core/setting/table.hpp"
#include "model/input_errors.hpp"
#include "model/linear_states.hpp"

namespace sysid {
namespace {

using Problem = InputErrorProblem;

constexpr char const* normal_noise = "write `normal(..., sd = s)`";

Channel const* channel_of_other_noise(Model const& model) {
  auto const found =
      std::find_if(model.channels.begin(), model.channels.end(), [](Channel const& each) { return !each.noise.row->gaussian; });
  return found == model.channels.end() ? nullptr : &*found;
}

/// Why, and what to do.
struct Refusal {
  errors::Subject reason;
  std::string help;
};

Refusal refusal_of(Problem const& problem, Model const& model) {
  std::string const& input = model.inputs[static_cast<std::size_t>(problem.input)].name;
  std::string const cure = fmt::format(
      "declare the error as a disturbance of the model, `disturbance e ~ ornstein_uhlenbeck(sd = s, time = T)`, and write `{} + e`",
      input);
  switch (problem.kind) {
    case Problem::Kind::rate:
      return {{fmt::format("the model uses its derivative `{}'`, but the errors of samples have none", input), {input + "'"}},
              fmt::format(
                  "declare the error of the derivative as a disturbance of the model, `disturbance e ~ white(intensity = q)`, and "
                  "write `{}' + e`",
                  input)};
    case Problem::Kind::channel:
      return {{fmt::format("channel `{}` depends on it directly", model.channels[static_cast<std::size_t>(problem.index)].name),
               {model.channels[static_cast<std::size_t>(problem.index)].name}},
              cure};
    case Problem::Kind::nonlinear:
      return {{"the equations are not linear in it"}, cure};
    case Problem::Kind::no_states:
      return {{fmt::format("model `{}` has no states, so that its rows are independent", model.name), {model.name}},
              "if the rows are equally far apart in time, declare `time discrete`"};
    case Problem::Kind::processes:
      return {{"the model has a Gaussian process"}, "fit the model without the process, or without the error"};
    case Problem::Kind::constraints:
      return {{"the model has algebraic unknowns or constraints"},
              "eliminate the unknowns, so that each state has its differential equation"};
  }
  return {};
}

}  // namespace

void TaskChecker::filter(ast::Option const& option, FilterRule& rule) {
  filter_ = option.span;
  std::string const given = as_word(option.value).value_or("");
  auto const found = find_filter(given);
  filter_needed_ = !found;  // refused here: nothing more is said of it
  if (!found) return diagnostics_.add(errors::option_choice(option.value.span, "filter", given, filter_names()));
  rule = *found;
}

void TaskChecker::report_needless_filter(FilterRule filter) {
  if (particles_ && filter != FilterRule::particle && !diagnostics_.has_errors(before_))
    diagnostics_.add(errors::particles_of_other_filter(*particles_, std::string(filter_name(filter))));
  if (filter_ && !filter_needed_ && !diagnostics_.has_errors(before_))
    diagnostics_.add(errors::filter_of_nothing(*filter_, tree_.subject.text));
}

std::vector<double> TaskChecker::input_errors(std::vector<ExperimentUse> const& experiments, Model const& model) {
  std::vector<double> sd(model.inputs.size(), 0);
  for (std::size_t i = 0; i < model.inputs.size(); ++i) {
    Quantity const& input = model.inputs[i];
    std::optional<Span> first;
    auto const text = [&](double value) {
      return value > 0 ? fmt::format("sd {:.6g}{}", input.from_si(value), input.unit ? " [" + input.unit_text() + "]" : "")
                       : std::string("no error");
    };
    for (ExperimentUse const& use : experiments) {
      DataBlock const& block = file_.data[static_cast<std::size_t>(use.data)];
      auto const bound = std::find_if(block.inputs.begin(), block.inputs.end(),
                                      [&](DataInputUse const& each) { return each.input == input.name; });
      if (bound == block.inputs.end()) continue;
      auto const& error = bound->error;
      if (error && error->unit && input.unit)
        if (auto refused =
                refuse_number(error->span, errors::named("the error of", input.name), *error->unit, difference(*input.unit))) {
          diagnostics_.add_once(std::move(*refused));
          return {};
        }
      double const own = !error ? 0 : error->bare ? input.to_si(error->sd) : error->sd;
      Span const place = error ? error->span : bound->input_span;
      if (first && own != sd[i]) {
        diagnostics_.add_once(errors::input_errors_differ(place, *first, input.name, text(own), text(sd[i])));
        return {};
      }
      if (!first) first = place;
      sd[i] = own;
    }
  }
  bool const any = std::any_of(sd.begin(), sd.end(), [](double each) { return each > 0; });
  return any ? sd : std::vector<double>();
}

std::optional<Model> TaskChecker::as_fitted(FitTask const& task, Model const& model) {
  Model ruled = with_prediction(model, task.prediction).value_or(model);
  if (task.input_errors.empty()) return ruled;
  auto with_errors = with_input_errors(ruled, task.input_errors);
  if (Model* const fitted = std::get_if<Model>(&with_errors)) return std::move(*fitted);
  auto const& problem = std::get<Problem>(with_errors);
  std::string const& input = model.inputs[static_cast<std::size_t>(problem.input)].name;
  std::optional<Label> place;
  if (problem.kind == Problem::Kind::channel)
    place = Label{model.channels[static_cast<std::size_t>(problem.index)].span, "depends on it"};
  else if (auto const span = problem.kind == Problem::Kind::nonlinear ? place_of(ruled.graph, problem.node) : std::nullopt)
    place = Label{*span, "not linear in it"};
  Refusal const refusal = refusal_of(problem, model);
  for (ExperimentUse const& use : task.experiments)
    for (DataInputUse const& bound : file_.data[static_cast<std::size_t>(use.data)].inputs)
      if (bound.input == input && bound.error) {
        diagnostics_.add_once(errors::input_error_refused(bound.error->span, input, refusal.reason, place, refusal.help));
        return std::nullopt;
      }
  return std::nullopt;
}

void TaskChecker::suit_noise(Model const& fitted, std::string const& help) {
  for (Channel const& channel : fitted.channels)
    if (!channel.noise.row->gaussian)
      diagnostics_.add_once(
          errors::noise_of_filter(channel.span, channel.name, std::string(channel.noise.row->name), tree_.subject.span, help));
}

std::vector<double> TaskChecker::predicted_input_errors(FitTask const& fit, std::vector<ExperimentUse> const& experiments) {
  Model const& model = file_.models[static_cast<std::size_t>(fit.model)];
  FitTask predicted = fit;
  predicted.experiments = experiments;
  predicted.input_errors = input_errors(experiments, model);
  if (predicted.input_errors.empty() || diagnostics_.has_errors(before_)) return {};
  if (fit.filter == FilterRule::particle) return predicted.input_errors;
  if (auto const fitted = as_fitted(predicted, model)) suit_noise(*fitted, normal_noise);
  return predicted.input_errors;
}

void TaskChecker::refuse_input_errors(std::vector<ExperimentUse> const& experiments) {
  for (ExperimentUse const& use : experiments)
    for (DataInputUse const& bound : file_.data[static_cast<std::size_t>(use.data)].inputs)
      if (bound.error)
        return diagnostics_.add(errors::input_error_refused(
            bound.error->span, bound.input, {"`discover` treats inputs as exact"}, Label{tree_.subject.span, "discovered here"},
            "discover from a data block without `error`, then fit the resulting model to this data block"));
}

void TaskChecker::suit_filter(FitTask& task, Model const& model) {
  if (diagnostics_.has_errors(before_)) return;
  task.input_errors = input_errors(task.experiments, model);
  std::optional<Model> const as_whole = as_fitted(task, model);
  if (!as_whole || !as_whole->filtered()) return;
  Model const& fitted = *as_whole;
  filter_needed_ = true;
  suit_particles(task, fitted);
  suit_kalman(task, fitted);
  if (task.start.kind != StartRule::Kind::estimated) return;
  for (State const& state : fitted.states) {
    bool const disturbance = std::any_of(fitted.disturbances.begin(), fitted.disturbances.end(),
                                         [&](Disturbance const& each) { return each.span == state.span; });
    if (!state.initial_variance || disturbance) continue;
    for (ast::Option const& option : tree_.options)
      if (key_of(option) == "start")
        return diagnostics_.add(errors::estimated_and_random_start(option.span, state.span, state.name));
  }
}

void TaskChecker::suit_distances(SelectTask const& task) {
  BackendSettings const* const selector = row_named(backends_.selecting, task.backend);
  if (selector == nullptr || !selector->distances || diagnostics_.has_errors(before_)) return;
  for (FitTask const& fit : task.fits) {
    if (fit.start.kind != StartRule::Kind::estimated) continue;
    std::optional<Model> const fitted = as_fitted(fit, file_.models[static_cast<std::size_t>(fit.model)]);
    if (!fitted || !fitted->filtered()) continue;
    // Each simulation draws its random states, so the first rows do not say where it began.
    return diagnostics_.add(errors::disturbance_beside(
        place_of_option("start"), errors::named("the random states of", fitted->name),
        {"`start = estimated` in a selection by distances", {"start"}},
        "remove the option, or give the initial values a distribution, `initial y ~ normal(0, sd = s)`: each simulation then draws "
        "its start"));
  }
}

Span TaskChecker::place_of_option(std::string const& name) const {
  for (ast::Option const& option : tree_.options)
    if (key_of(option) == name) return option.key ? option.span : head_span(option.value);
  return tree_.verb.span;
}

void TaskChecker::suit_particles(FitTask& task, Model const& fitted) {
  Channel const* const other = channel_of_other_noise(fitted);
  BackendSettings const* const backend = row_named(backends_.fitting, task.backend);
  bool const estimates = backend != nullptr && backend->estimates;
  if (task.filter == FilterRule::particle) return refuse_particles(task, fitted);
  if (other == nullptr) return;
  bool const may_choose = task.filter == FilterRule::automatic && task.start.kind != StartRule::Kind::estimated;
  if (estimates && may_choose) {
    task.filter = FilterRule::particle;
    task.particles_because =
        fmt::format("no other filter supports the noise of `{}`, which is `{}`", other->name, other->noise.row->name);
  } else if (tree_.verb.text == "select") {
    suit_noise(fitted, normal_noise);
  } else {
    suit_noise(fitted, fmt::format("fit with `mh` and `filter = particle`, or {}", normal_noise));
  }
}

void TaskChecker::refuse_particles(FitTask const& task, Model const& fitted) {
  std::string const otherwise = channel_of_other_noise(fitted) == nullptr ? ", or write `filter = unscented`" : "";
  if (tree_.verb.text == "select")
    return diagnostics_.add_once(
        errors::likelihood_by_particles(*filter_, {"`select` compares likelihoods of candidates", {"select"}},
                                        "fit each candidate with `mh` and compare the results by `sysid compare`" + otherwise));
  BackendSettings const* const backend = row_named(backends_.fitting, task.backend);
  if (backend != nullptr && !backend->estimates)
    diagnostics_.add(errors::likelihood_by_particles(
        place_of_option(task.backend), {fmt::format("`{}` needs the likelihood itself", backend->name), {task.backend}},
        "sample with `mh`" + otherwise));
  if (task.start.kind == StartRule::Kind::estimated)
    diagnostics_.add(
        errors::likelihood_by_particles(place_of_option("start"), {"`start = estimated` needs the likelihood itself", {"start"}},
                                        "give the initial values a prior, `initial y ~ normal(0, sd = s)`" + otherwise));
}

void TaskChecker::suit_forecast(std::vector<FitTask const*> const& fits, PredictTask const& task) {
  for (std::size_t k = 0; k < fits.size(); ++k) {
    if (fits[k]->filter != FilterRule::particle) continue;
    ast::Name const& name = k == 0 ? tree_.subject : tree_.others[k - 1];
    if (fits.size() > 1)
      return diagnostics_.add(errors::likelihood_by_particles(
          name.span, {fmt::format("an average needs densities of samples under `{}`", name.text), {name.text}},
          "predict with each fit by itself"));
    if (task.start.kind == StartRule::Kind::estimated)
      return diagnostics_.add(errors::likelihood_by_particles(
          place_of_option("start"), {"`start = estimated` needs the likelihood itself", {"start"}},
          "remove the option: the states are then estimated from the rows before the predicted ones"));
  }
}

void TaskChecker::suit_kalman(FitTask const& task, Model const& model) {
  if (task.filter != FilterRule::kalman) return;
  auto const node = find_nonlinear_in_states(model);
  if (node) diagnostics_.add_once(errors::kalman_of_nonlinear(*filter_, model.name, place_of(model.graph, *node)));
}

}  // namespace sysid
