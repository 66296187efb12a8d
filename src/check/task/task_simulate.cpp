// `simulate`: values, inputs, noise and sampling of a record that is made.
#include "check/task/task_checker.hpp"

#include <algorithm>

#include "check/data/data.hpp"
#include "check/message/errors.hpp"
#include "check/task/signal_generators.hpp"
#include "check/task/task_options.hpp"

namespace sysid {
namespace {

/// Of a function drawn from its prior: the factor of so many samples takes some seconds.
constexpr int most_drawn = 5000;

}  // namespace

SimulateTask TaskChecker::simulate() {
  SimulateTask task;
  if (!tree_.data.empty()) diagnostics_.add(errors::data_unused(tree_, tree_.data.front().span));
  auto const found = item(tree_.subject, names_.models, "model");
  if (!found) return task;
  task.model = *found;
  Model const& model = file_.models[static_cast<std::size_t>(*found)];
  if (model.channels.empty()) {
    diagnostics_.add(errors::nothing_observed(tree_.subject));
    return task;
  }
  for (Parameter const& parameter : model.parameters)
    task.values.push_back(parameter.per_experiment && parameter.value ? model.graph.constant_value(*parameter.value)
                                                                      : std::nullopt);
  task.inputs.resize(model.inputs.size());
  std::vector<bool> given(model.inputs.size(), false);
  std::vector<Span> places(model.inputs.size());
  std::optional<Span> spacing;
  Span noise_place = tree_.verb.span;
  for (ast::Option const& option : tree_.options) {
    std::string const key = key_of(option);
    if (!options_.fresh(option, key)) continue;
    if (option.input) {
      auto const place =
          std::find_if(model.inputs.begin(), model.inputs.end(), [&](Quantity const& each) { return each.name == key; });
      if (place == model.inputs.end()) {
        std::vector<std::string> known;
        for (Quantity const& input : model.inputs) known.push_back(input.name);
        diagnostics_.add(errors::unknown_member(*option.key, "model `" + model.name + "`", "input", known));
        continue;
      }
      auto const index = static_cast<std::size_t>(place - model.inputs.begin());
      given[index] = true;
      places[index] = option.value.span;
      if (auto generated = check_generator(option, *place, options_, diagnostics_)) task.inputs[index] = std::move(*generated);
    } else if (key == "values" && as_call(option.value) != nullptr) {
      values(*as_call(option.value), model, task);
    } else if (option.key && key == "noise") {
      noise_place = option.span;
      if (as_word(option.value) == "model")
        task.noise_fraction = -1;
      else if (auto const value = options_.number(option.value, key, unit_of("percent"), 0, 1e6))
        task.noise_fraction = *value;
    } else if (option.key && key == "samples") {
      options_.whole(option, key, 2, 1e8, task.samples);
    } else if (option.key && (key == "rate" || key == "step")) {
      if (spacing) diagnostics_.add(errors::stated_twice(option.span, *spacing, "the time between samples"));
      spacing = option.span;
      if (auto const value = options_.number(option.value, key, unit_of(key == "rate" ? "Hz" : "s"), 1e-300, 1e300))
        task.step = key == "rate" ? 1 / *value : *value;
    } else if (option.key && (key == "substeps" || key == "solver")) {
      options_.solver(option, task.solver);
    } else if (option.key && key == "seed") {
      options_.seed(option, task.seed);
    } else if (option.key && key == "file") {
      if (auto const* text = std::get_if<ast::Text>(&option.value.node);
          text != nullptr && text->value.find('/') == std::string::npos)
        task.file = text->value;
      else
        diagnostics_.add(
            errors::option_kind(option.value.span, key, "a file name in quotes, without folders", "file = \"truth.csv\""));
    } else {
      options_.unknown(option, task_option_names("simulate"));
    }
  }
  if (task.noise_fraction >= 0)
    for (Channel const& channel : model.channels)
      if (channel.noise.row->discrete)
        diagnostics_.add(errors::noise_of_counts(noise_place, channel.name, std::string(channel.noise.row->name)));
  suit(task.solver, model);
  if (task.file.empty()) task.file = task_name(tree_) + ".csv";
  if (diagnostics_.has_errors(before_)) return task;
  if (!model.processes.empty() && task.samples > most_drawn)
    diagnostics_.add(errors::process_of_many_samples(tree_.subject.span, model.name, most_drawn));
  if (task.samples == 0) diagnostics_.add(errors::option_missing(tree_, "samples", "samples = 500"));
  if (model.step && task.step > 0 && !same_step(task.step, *model.step))
    diagnostics_.add(errors::other_step(*spacing, task.step, *model.step, model.name));
  if (task.step == 0 && model.step) task.step = *model.step;
  if (task.step == 0 && model.dynamics == Dynamics::none) task.step = 1;
  if (!model.integrated()) task.solver = {};
  if (task.step == 0) diagnostics_.add(errors::option_missing(tree_, "rate", "rate = 1000 [Hz]"));
  for (std::size_t i = 0; i < given.size(); ++i)
    if (!given[i])
      diagnostics_.add(
          errors::option_missing(tree_, "input " + model.inputs[i].name, "input " + model.inputs[i].name + " = gaussian(sd = 1)"));
  if (auto const missing = values_needed(model, task); !missing.empty())
    diagnostics_.add(errors::value_missing(tree_.verb.span, missing));
  if (task.samples > 0 && task.step > 0)
    for (std::size_t i = 0; i < given.size(); ++i)
      if (given[i]) check_band(task.inputs[i], task, places[i], diagnostics_);
  return task;
}

void TaskChecker::values(ast::Call const& call, Model const& model, SimulateTask& task) {
  std::vector<std::string> known;
  for (Parameter const& parameter : model.parameters) known.push_back(parameter.name);
  each_named(call, "model `" + model.name + "`", "parameter", known, [&](ast::Argument const& argument, std::size_t index) {
    if (model.parameters[index].value && !model.parameters[index].per_experiment) {
      diagnostics_.add(errors::fixed_parameter(*argument.name, model.parameters[index].span));
      return;
    }
    std::optional<Unit> const& unit = model.parameters[index].unit;
    if (auto const value = options_.number(argument.value, argument.name->text, unit, -1e300, 1e300)) task.values[index] = *value;
  });
}

std::vector<std::string> TaskChecker::values_needed(Model const& model, SimulateTask const& task) const {
  std::vector<NodeId> roots = read_by(model.processes);
  for (State const& state : model.states) roots.insert(roots.end(), {state.derivative, state.initial});
  roots.insert(roots.end(), model.residuals.begin(), model.residuals.end());
  for (Unknown const& unknown : model.unknowns) roots.push_back(unknown.guess);
  Graph graph = model.graph;
  for (Channel const& channel : model.channels) {
    if (task.noise_fraction >= 0)
      roots.push_back(channel.noise.row->centre(graph, channel.noise.arguments));
    else
      roots.insert(roots.end(), channel.noise.arguments.begin(), channel.noise.arguments.end());
  }
  std::vector<std::string> missing;
  for (NodeId const id : graph.reachable(roots)) {
    Node const& node = graph[id];
    if (node.operation != Operation::leaf || node.leaf_kind != LeafKind::parameter) continue;
    auto const index = static_cast<std::size_t>(node.index);
    if (model.parameters[index].coefficient) continue;  // drawn, as a function is
    if (!task.values[index] && !model.parameters[index].value) missing.push_back(model.parameters[index].name);
  }
  std::sort(missing.begin(), missing.end());
  return missing;
}

}  // namespace sysid
