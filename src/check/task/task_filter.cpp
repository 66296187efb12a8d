// How the likelihood of random states is computed, and the errors of inputs, which make states random.
#include <fmt/format.h>

#include <algorithm>

#include "check/expression/leaves.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_disturbances.hpp"
#include "check/task/task_checker.hpp"
#include "check/units/units.hpp"
#include "model/input_errors.hpp"
#include "model/linear_states.hpp"

namespace sysid {
namespace {

using Problem = InputErrorProblem;

/// Why, and what to do.
struct Refusal {
  std::string reason, help;
};

Refusal refusal_of(Problem const& problem, Model const& model) {
  std::string const& input = model.inputs[static_cast<std::size_t>(problem.input)].name;
  std::string const cure = fmt::format(
      "declare the error as a disturbance of the model, `disturbance e ~ ornstein_uhlenbeck(sd = s, time = T)`, and write `{} + e`",
      input);
  switch (problem.kind) {
    case Problem::Kind::rate:
      return {fmt::format("the model reads its derivative `{}'`, which errors of samples do not have", input), cure};
    case Problem::Kind::channel:
      return {fmt::format("channel `{}` reads it directly", model.channels[static_cast<std::size_t>(problem.index)].name), cure};
    case Problem::Kind::nonlinear:
      return {"the equations are not linear in it", cure};
    case Problem::Kind::no_states:
      return {fmt::format("model `{}` has no states, so that its rows are independent", model.name),
              "if the rows are equally far apart in time, declare `time discrete`"};
    case Problem::Kind::processes:
      return {"the model has a Gaussian process", "fit the model without the process, or without the error"};
    case Problem::Kind::constraints:
      return {"the model has algebraic unknowns or constraints",
              "eliminate the unknowns, so that each state has its differential equation"};
  }
  return {};
}

}  // namespace

void TaskChecker::filter(ast::Option const& option, FilterRule& rule) {
  filter_ = option.span;
  std::string const given = as_word(option.value).value_or("");
  if (auto const found = find_filter(given))
    rule = *found;
  else
    diagnostics_.add(errors::option_choice(option.value.span, "filter", given, filter_names()));
  filter_needed_ = !find_filter(given);  // nothing more is said of a word that is none
}

void TaskChecker::report_needless_filter() {
  if (filter_ && !filter_needed_) diagnostics_.add(errors::filter_of_nothing(*filter_, tree_.subject.text));
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

void TaskChecker::suit_filter(FitTask& task, Model const& model) {
  if (diagnostics_.has_errors(before_)) return;
  task.input_errors = input_errors(task.experiments, model);
  Model fitted = with_prediction(model, task.prediction).value_or(model);
  if (!task.input_errors.empty()) {
    auto with_errors = with_input_errors(fitted, task.input_errors);
    if (auto const* problem = std::get_if<Problem>(&with_errors)) {
      std::string const& input = model.inputs[static_cast<std::size_t>(problem->input)].name;
      std::optional<Label> place;
      if (problem->kind == Problem::Kind::channel)
        place = Label{model.channels[static_cast<std::size_t>(problem->index)].span, "reads it"};
      else if (auto const span = problem->kind == Problem::Kind::nonlinear ? place_of(fitted.graph, problem->node) : std::nullopt)
        place = Label{*span, "not linear in it"};
      DataBlock const& block = file_.data[static_cast<std::size_t>(task.experiments.front().data)];
      for (DataInputUse const& bound : block.inputs)
        if (bound.input == input && bound.error) {
          Refusal const refusal = refusal_of(*problem, model);
          diagnostics_.add_once(errors::input_error_refused(bound.error->span, input, refusal.reason, place, refusal.help));
        }
      return;
    }
    fitted = std::get<Model>(std::move(with_errors));
  }
  if (!fitted.filtered()) return;
  filter_needed_ = true;
  for (Channel const& channel : fitted.channels)
    if (task.filter != FilterRule::particle && !channel.noise.row->gaussian)
      diagnostics_.add_once(
          errors::noise_of_filter(channel.span, channel.name, std::string(channel.noise.row->name), tree_.subject.span));
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

void TaskChecker::suit_kalman(FitTask const& task, Model const& model) {
  if (task.filter != FilterRule::kalman) return;
  auto const node = find_nonlinear_in_states(model);
  if (node) diagnostics_.add_once(errors::kalman_of_nonlinear(*filter_, model.name, place_of(model.graph, *node)));
}

}  // namespace sysid
