// `simulate`: values, inputs, noise and sampling of a record that is made.
#include "check/task/task_checker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "check/message/errors.hpp"
#include "check/task/signal_generators.hpp"
#include "check/task/task_options.hpp"
#include "core/setting/table.hpp"
#include "data/input_rule.hpp"
#include "solver/linear_structure.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

/// Of a function drawn from its prior: the factor of so many samples takes some seconds.
constexpr int most_drawn = 5000;

/// Of a file in the folder of the results: none of those that results have beside their tables.
bool names_a_table(std::string const& name) {
  if (name.empty() || name == "." || name == ".." || name.find('/') != std::string::npos) return false;
  constexpr char const* endings[] = {".json", ".html", ".cbor", ".sysid"};
  return std::none_of(std::begin(endings), std::end(endings), [&](char const* each) { return name.ends_with(each); });
}

}  // namespace

struct TaskChecker::SimulateOptions {
  Model const& model;
  SimulateTask& task;
  std::vector<bool> given;   // of the inputs
  std::vector<Span> places;  // of their signals
  std::optional<Span> spacing;
  Span noise;
};

// Every option that is written `NAME = VALUE`, with what reads it.
struct TaskChecker::SimulateOptionRow {
  std::string_view name;
  void (*take)(TaskChecker&, ast::Option const&, SimulateOptions&);
};

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
  SimulateOptions options{.model = model,
                          .task = task,
                          .given = std::vector<bool>(model.inputs.size(), false),
                          .places = std::vector<Span>(model.inputs.size()),
                          .spacing = std::nullopt,
                          .noise = tree_.verb.span};
  for (ast::Option const& option : tree_.options) simulate_option(option, options);
  if (task.noise_fraction >= 0)
    for (Channel const& channel : model.channels)
      if (channel.noise.row->discrete)
        diagnostics_.add(errors::noise_of_counts(options.noise, channel.name, std::string(channel.noise.row->name)));
  suit(task.solver, model);
  report_needless_solver();
  if (task.file.empty()) task.file = task_name(tree_) + ".csv";
  if (!diagnostics_.has_errors(before_)) complete_simulation(options);
  return task;
}

void TaskChecker::simulate_option(ast::Option const& option, SimulateOptions& options) {
  static constexpr SimulateOptionRow rows[] = {
      {"noise", &TaskChecker::simulate_noise},     {"samples", &TaskChecker::simulate_samples},
      {"rate", &TaskChecker::simulate_spacing},    {"step", &TaskChecker::simulate_spacing},
      {"substeps", &TaskChecker::simulate_solver}, {"solver", &TaskChecker::simulate_solver},
      {"seed", &TaskChecker::simulate_seed},       {"file", &TaskChecker::simulate_file},
  };
  std::string const key = key_of(option);
  if (!options_.fresh(option, key)) return;
  SimulateOptionRow const* const row = option.key ? row_named(rows, key) : nullptr;
  if (option.input)
    simulate_input(option, options);
  else if (key == "values" && as_call(option.value) != nullptr)
    values(*as_call(option.value), options.model, options.task);
  else if (row != nullptr)
    row->take(*this, option, options);
  else
    options_.unknown(option, task_option_names("simulate"));
}

void TaskChecker::simulate_input(ast::Option const& option, SimulateOptions& options) {
  std::vector<Quantity> const& inputs = options.model.inputs;
  auto const place = std::find_if(inputs.begin(), inputs.end(), [&](Quantity const& each) { return each.name == key_of(option); });
  if (place == inputs.end()) {
    std::vector<std::string> known;
    for (Quantity const& input : inputs) known.push_back(input.name);
    diagnostics_.add(errors::unknown_member(*option.key, errors::named("model", options.model.name), "input", known));
    return;
  }
  auto const index = static_cast<std::size_t>(place - inputs.begin());
  options.given[index] = true;
  options.places[index] = option.value.span;
  if (auto generated = check_generator(option, *place, options_, diagnostics_)) options.task.inputs[index] = std::move(*generated);
}

void TaskChecker::simulate_noise(TaskChecker& checker, ast::Option const& option, SimulateOptions& options) {
  options.noise = option.span;
  if (as_word(option.value) == "model")
    options.task.noise_fraction = -1;
  else if (auto const value = checker.options_.pure_number(option.value, key_of(option), unit_of("percent"), 0, 1e6))
    options.task.noise_fraction = *value;
}

void TaskChecker::simulate_samples(TaskChecker& checker, ast::Option const& option, SimulateOptions& options) {
  auto const rows = checker.options_.number(option.value, key_of(option), Unit{}, 2, 1e8, true, OptionReader::time_for_rows());
  if (rows) options.task.samples = static_cast<int>(*rows);
}

void TaskChecker::simulate_spacing(TaskChecker& checker, ast::Option const& option, SimulateOptions& options) {
  std::string const key = key_of(option);
  if (options.spacing) checker.diagnostics_.add(errors::stated_twice(option.span, *options.spacing, {"the time between samples"}));
  options.spacing = option.span;
  bool const rate = key == "rate";
  std::string const number = unparse(option.value);
  OptionReader::OtherPlace const other =
      rate
          ? OptionReader::OtherPlace{unit_of("s"), fmt::format("this is the time between two samples: write `step = {}`", number)}
          : OptionReader::OtherPlace{unit_of("Hz"), fmt::format("this is a number of samples per time: write `rate = {}`", number)};
  if (auto const value = checker.options_.number(option.value, key, unit_of(rate ? "Hz" : "s"), 1e-300, 1e300, false, other))
    options.task.step = rate ? 1 / *value : *value;
}

void TaskChecker::simulate_solver(TaskChecker& checker, ast::Option const& option, SimulateOptions& options) {
  checker.options_.solver(option, options.task.solver);
}

void TaskChecker::simulate_seed(TaskChecker& checker, ast::Option const& option, SimulateOptions& options) {
  checker.options_.seed(option, options.task.seed);
}

void TaskChecker::simulate_file(TaskChecker& checker, ast::Option const& option, SimulateOptions& options) {
  auto const* text = std::get_if<ast::Text>(&option.value.node);
  if (text != nullptr && names_a_table(text->value))
    options.task.file = text->value;
  else
    checker.diagnostics_.add(errors::option_kind(option.value.span, key_of(option),
                                                 {"the name of a text table in quotes, without folders"}, "file = \"truth.csv\""));
}

void TaskChecker::check_exact_inputs(SimulateOptions const& options) {
  Model const& model = options.model;
  SolverSettings const& solver = options.task.solver;
  if (!solver.row().exact) return;
  std::vector<NodeId> derivatives;
  for (State const& state : model.states) derivatives.push_back(state.derivative);
  std::vector<int> const to_hold = inputs_not_linear(model.graph, derivatives);
  for (std::size_t i = 0; i < options.given.size(); ++i) {
    bool const held = std::find(to_hold.begin(), to_hold.end(), static_cast<int>(i)) != to_hold.end();
    if (options.given[i] && row_of(options.task.inputs[i].rule).degree > (held ? 0 : 1))
      diagnostics_.add(
          errors::input_of_exact_solver(options.places[i], model.inputs[i].name, *options_.solver_span(), solver.method, held));
  }
}

void TaskChecker::complete_simulation(SimulateOptions const& options) {
  Model const& model = options.model;
  SimulateTask& task = options.task;
  if (!model.processes.empty() && task.samples > most_drawn)
    diagnostics_.add(errors::process_of_many_samples(tree_.subject.span, model.name, most_drawn));
  if (task.samples == 0) diagnostics_.add(errors::option_missing(tree_, "samples", "samples = 500"));
  if (model.step && task.step > 0 && !same_step(task.step, *model.step))
    diagnostics_.add(errors::other_step(*options.spacing, task.step, *model.step, model.name));
  if (task.step == 0 && model.step) task.step = *model.step;
  if (task.step == 0 && model.dynamics == Dynamics::none) task.step = 1;
  if (!model.integrated()) task.solver = {};
  if (task.step == 0) diagnostics_.add(errors::option_missing(tree_, "rate", "rate = 1000 [Hz]"));
  for (std::size_t i = 0; i < options.given.size(); ++i)
    if (!options.given[i])
      diagnostics_.add(
          errors::option_missing(tree_, "input " + model.inputs[i].name, "input " + model.inputs[i].name + " = gaussian(sd = 1)"));
  if (auto const missing = values_needed(model, task); !missing.empty())
    diagnostics_.add(errors::value_missing(tree_.verb.span, missing));
  check_exact_inputs(options);
  if (task.samples > 0 && task.step > 0)
    for (std::size_t i = 0; i < options.given.size(); ++i)
      if (options.given[i]) check_band(task.inputs[i], task, options.places[i], diagnostics_);
}

namespace {

/// Beyond bounds that are numbers.
bool outside(Graph graph, Distribution const& prior, double value) {
  Support const bounds = support(graph, prior);
  auto const number = [&](std::optional<NodeId> const& bound) { return bound ? graph.constant_value(*bound) : std::nullopt; };
  auto const lower = number(bounds.lower), upper = number(bounds.upper);
  auto const rounding = [](double bound) { return 1e-9 * std::fabs(bound); };  // of the conversion of units
  return (lower && value < *lower - rounding(*lower)) || (upper && value > *upper + rounding(*upper));
}

}  // namespace

void TaskChecker::values(ast::Call const& call, Model const& model, SimulateTask& task) {
  std::vector<std::string> known;
  for (Parameter const& parameter : model.parameters) known.push_back(parameter.name);
  each_named(call, errors::named("model", model.name), "parameter", known, [&](ast::Argument const& argument, std::size_t index) {
    if (model.parameters[index].value && !model.parameters[index].per_experiment) {
      diagnostics_.add(errors::fixed_parameter(*argument.name, model.parameters[index].span));
      return;
    }
    std::optional<Unit> const& unit = model.parameters[index].unit;
    auto const value = options_.number(argument.value, argument.name->text, unit, -1e300, 1e300);
    if (!value) return;
    task.values[index] = *value;
    if (model.parameters[index].prior && outside(model.graph, *model.parameters[index].prior, *value))
      diagnostics_.add(errors::value_outside_prior(argument.span, argument.name->text, model.parameters[index].span));
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
