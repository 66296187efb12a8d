// simulate, fit and predict: what they refer to and which options they have.
#include "check/tasks.hpp"

#include <algorithm>

#include "check/data.hpp"
#include "check/errors.hpp"
#include "check/generator.hpp"
#include "check/option_reader.hpp"

namespace sysid {
namespace {

class TaskChecker {
 public:
  TaskChecker(ast::Task const& tree, TaskNames const& names, CheckedFile const& file, std::span<BackendSettings const> backends,
              std::span<ast::Task const* const> all_tasks, Diagnostics& diagnostics)
      : tree_(tree),
        names_(names),
        file_(file),
        backends_(backends),
        all_tasks_(all_tasks),
        diagnostics_(diagnostics),
        before_(diagnostics.all().size()),
        options_(tree.verb.text, diagnostics) {}

  std::optional<Task> run() {
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

 private:
  std::optional<int> item(ast::Name const& name, std::map<std::string, std::optional<int>> const& items, std::string const& kind) {
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

  // One experiment of the task, without its name; nothing when a diagnostic was added.
  std::optional<ExperimentUse> experiment(ast::DataReference const& reference, Model const* model) {
    auto const found = item(reference.data, names_.data, "data block");
    if (!found) return std::nullopt;
    ExperimentUse use;
    use.data = *found;
    DataBlock const& block = file_.data[static_cast<std::size_t>(use.data)];
    if (reference.part) {
      auto const place = std::find_if(block.parts.begin(), block.parts.end(),
                                      [&](DataPart const& each) { return each.name == reference.part->text; });
      if (place == block.parts.end()) {
        std::vector<std::string> known;
        for (DataPart const& each : block.parts) known.push_back(each.name);
        diagnostics_.add(errors::unknown_member(*reference.part, "data `" + block.name + "`", "part", known));
        return std::nullopt;
      }
      use.part = static_cast<int>(place - block.parts.begin());
    }
    if (model == nullptr) return std::nullopt;
    check_binding(block, *model, file_.models, reference.span, diagnostics_);
    use.constants = check_constants(block, *model, file_.models, reference.span, diagnostics_);
    return use;
  }

  std::vector<ExperimentUse> experiments(Model const* model, std::string const& preposition) {
    std::vector<ExperimentUse> uses;
    if (tree_.data.empty()) diagnostics_.add(errors::data_missing(tree_, preposition));
    std::vector<Span> places;
    for (ast::DataReference const& reference : tree_.data)
      if (auto use = experiment(reference, model)) {
        uses.push_back(std::move(*use));
        places.push_back(reference.span);
      }
    for (std::size_t i = 0; i < uses.size(); ++i) {
      DataBlock const& block = file_.data[static_cast<std::size_t>(uses[i].data)];
      auto const same = [&](ExperimentUse const& other) { return other.data == uses[i].data; };
      bool const alone = std::count_if(uses.begin(), uses.end(), same) == 1;
      uses[i].name = alone ? block.name : part_name(block, uses[i].part);
      for (std::size_t before = 0; before < i && preposition == "to"; ++before)
        if (same(uses[before]) && share_rows(block, uses[before].part, uses[i].part)) {
          diagnostics_.add(uses[before].part == uses[i].part
                               ? errors::experiment_twice(places[i], places[before], part_name(block, uses[i].part))
                               : errors::experiments_overlap(places[i], places[before], part_name(block, uses[i].part),
                                                             part_name(block, uses[before].part)));
          break;
        }
    }
    return uses;
  }

  static std::string part_name(DataBlock const& block, int part) {
    return part < 0 ? block.name : block.name + "." + block.parts[static_cast<std::size_t>(part)].name;
  }
  static bool share_rows(DataBlock const& block, int one, int other) {
    if (one < 0 || other < 0) return true;
    DataPart const& a = block.parts[static_cast<std::size_t>(one)];
    DataPart const& b = block.parts[static_cast<std::size_t>(other)];
    return (a.last == 0 || b.first <= a.last) && (b.last == 0 || a.first <= b.last);
  }

  // Equations that cannot be solved for their highest derivatives need a solver that does without.
  void suit(SolverSettings& solver, Model const& model) {
    if (!model.implicit) return;
    if (!options_.solver_span())
      solver = {.method = "ida"};
    else if (solver.row().stepping != Stepping::ida)
      diagnostics_.add(
          errors::explicit_solver(*options_.solver_span(), solver.method, model.implicit->equation, model.implicit->unknown));
  }

  void suit(StartRule const& start, Model const& model, std::vector<ast::Option> const& options) {
    if (start.kind != StartRule::Kind::estimated || model.invariants.empty()) return;
    for (ast::Option const& option : options)
      if (key_of(option) == "start")
        diagnostics_.add(errors::estimated_start_of_constraint(option.span, model.invariants.front().span));
  }

  FitTask fit() {
    FitTask task;
    std::vector<std::string> names;
    for (BackendSettings const& backend : backends_) names.emplace_back(backend.name);
    auto const model = item(tree_.subject, names_.models, "model");
    if (model) task.model = *model;
    if (model && file_.models[static_cast<std::size_t>(*model)].channels.empty()) {
      diagnostics_.add(errors::nothing_observed(tree_.subject));
      return task;
    }
    task.experiments = experiments(model ? &file_.models[static_cast<std::size_t>(*model)] : nullptr, "to");
    for (ast::Option const& option : tree_.options) {
      std::string const key = key_of(option);
      auto const backend = std::find_if(backends_.begin(), backends_.end(), [&](auto const& each) { return each.name == key; });
      if (!option.input && !option.key && backend != backends_.end()) {
        if (!options_.fresh(option, the_backend)) continue;
        task.backend = key;
        task.settings = Settings(backend->settings);
        if (ast::Call const* call = as_call(option.value)) options_.settings(*call, backend->settings, task.settings);
      } else if (!option.input && option.key && key == "start") {
        if (options_.fresh(option, key)) options_.start(option, task.start);
      } else if (!option.input && option.key && (key == "substeps" || key == "solver")) {
        if (options_.fresh(option, key)) task.settle = !options_.solver(option, task.solver);
      } else if (!option.input && option.key && key == "prediction") {
        if (options_.fresh(option, key))
          prediction(option, model ? &file_.models[static_cast<std::size_t>(*model)] : nullptr, task.prediction);
      } else if (!option.input && option.key && key == "seed") {
        if (options_.fresh(option, key)) options_.seed(option, task.seed);
      } else if (!option.input && !option.key && !key.empty()) {
        diagnostics_.add(errors::unknown_backend({{head_span(option.value)}, key}, names));
        task.backend = key;  // said once is enough
      } else {
        options_.unknown(option, {"start", "solver", "substeps", "prediction", "seed"});
      }
    }
    if (model) {
      Model const& whole = file_.models[static_cast<std::size_t>(*model)];
      suit(task.solver, whole);
      suit(task.start, whole, tree_.options);
      if (!whole.integrated()) {  // there is nothing to solve
        task.solver = {};
        task.settle = false;
      }
    }
    if (task.backend.empty() && !diagnostics_.has_errors(before_)) diagnostics_.add(errors::backend_missing(tree_, names));
    return task;
  }

  PredictTask predict() {
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

  void prediction(ast::Option const& option, Model const* model, PredictionRule& rule) {
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

  // The names that states, channel locations and (when the model makes the noise) noise need.
  std::vector<std::string> values_needed(Model const& model, SimulateTask const& task) const {
    std::vector<NodeId> roots;
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
      if (!task.values[index] && !model.parameters[index].value) missing.push_back(model.parameters[index].name);
    }
    std::sort(missing.begin(), missing.end());
    return missing;
  }

  SimulateTask simulate() {
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
    std::vector<std::string> const options = {"values", "input",  "noise",    "samples", "rate",
                                              "step",   "solver", "substeps", "seed",    "file"};
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
        options_.unknown(option, options);
      }
    }
    if (task.noise_fraction >= 0)
      for (Channel const& channel : model.channels)
        if (channel.noise.row->discrete)
          diagnostics_.add(errors::noise_of_counts(noise_place, channel.name, std::string(channel.noise.row->name)));
    suit(task.solver, model);
    if (task.file.empty()) task.file = task_name(tree_) + ".csv";
    if (diagnostics_.has_errors(before_)) return task;
    if (task.samples == 0) diagnostics_.add(errors::option_missing(tree_, "samples", "samples = 500"));
    if (model.step && task.step > 0 && !same_step(task.step, *model.step))
      diagnostics_.add(errors::other_step(*spacing, task.step, *model.step, model.name));
    if (task.step == 0 && model.step) task.step = *model.step;
    if (task.step == 0 && model.dynamics == Dynamics::none) task.step = 1;
    if (!model.integrated()) task.solver = {};
    if (task.step == 0) diagnostics_.add(errors::option_missing(tree_, "rate", "rate = 1000 [Hz]"));
    for (std::size_t i = 0; i < given.size(); ++i)
      if (!given[i])
        diagnostics_.add(errors::option_missing(tree_, "input " + model.inputs[i].name,
                                                "input " + model.inputs[i].name + " = gaussian(sd = 1)"));
    if (auto const missing = values_needed(model, task); !missing.empty())
      diagnostics_.add(errors::value_missing(tree_.verb.span, missing));
    if (task.samples > 0 && task.step > 0)
      for (std::size_t i = 0; i < given.size(); ++i)
        if (given[i]) check_band(task.inputs[i], task, places[i], diagnostics_);
    return task;
  }

  void values(ast::Call const& call, Model const& model, SimulateTask& task) {
    std::vector<std::string> known;
    std::map<std::string, Span> given;
    for (Parameter const& parameter : model.parameters) known.push_back(parameter.name);
    for (ast::Argument const& argument : call.arguments) {
      if (!argument.name) {
        diagnostics_.add(errors::must_be_named(argument.span, "values", known));
        continue;
      }
      auto const place = std::find(known.begin(), known.end(), argument.name->text);
      if (place == known.end()) {
        diagnostics_.add(errors::unknown_member(*argument.name, "model `" + model.name + "`", "parameter", known));
        continue;
      }
      if (auto const [first, is_fresh] = given.emplace(argument.name->text, argument.span); !is_fresh) {
        diagnostics_.add(errors::stated_twice(argument.span, first->second, "`" + argument.name->text + "`"));
        continue;
      }
      auto const index = static_cast<std::size_t>(place - known.begin());
      if (model.parameters[index].value && !model.parameters[index].per_experiment) {
        diagnostics_.add(errors::fixed_parameter(*argument.name, model.parameters[index].span));
        continue;
      }
      std::optional<Unit> const& unit = model.parameters[index].unit;
      if (auto const value = options_.number(argument.value, argument.name->text, unit, -1e300, 1e300)) task.values[index] = *value;
    }
  }

  ast::Task const& tree_;
  TaskNames const& names_;
  CheckedFile const& file_;
  std::span<BackendSettings const> backends_;
  std::span<ast::Task const* const> all_tasks_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  OptionReader options_;
  bool unresolved_ = false;
};

}  // namespace

std::string task_name(ast::Task const& tree) { return tree.name ? tree.name->text : tree.verb.text + "_" + tree.subject.text; }

std::optional<Task> check_task(ast::Task const& tree, TaskNames const& names, CheckedFile const& file,
                               std::span<BackendSettings const> backends, std::span<ast::Task const* const> all_tasks,
                               Diagnostics& diagnostics) {
  return TaskChecker(tree, names, file, backends, all_tasks, diagnostics).run();
}

}  // namespace sysid
