// simulate, fit and predict: their options by name, each with its kind, range and unit.
#include "check/tasks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "check/data.hpp"
#include "check/errors.hpp"
#include "check/scope.hpp"

namespace sysid {
namespace {

constexpr int default_start_rows = 50;
constexpr char const* the_backend = "the back end";

Unit unit_of(std::string_view atom) { return atom.empty() ? Unit{} : unit_atom(atom).value(); }

std::string key_of(ast::Option const& option) {
  if (option.key) return option.key->text;
  if (auto const* call = std::get_if<ast::Box<ast::Call>>(&option.value.node)) return (*call)->function.text;
  if (auto const* reference = std::get_if<ast::Reference>(&option.value.node)) return reference->name.text;
  return {};
}

ast::Call const* as_call(ast::Expression const& expression) {
  auto const* call = std::get_if<ast::Box<ast::Call>>(&expression.node);
  return call == nullptr ? nullptr : &**call;
}

// Where the function's or quantity's name stands.
Span head_span(ast::Expression const& expression) {
  auto const* call = as_call(expression);
  return call == nullptr ? expression.span : call->function.span;
}

std::optional<std::string> as_word(ast::Expression const& expression) {
  if (auto const* reference = std::get_if<ast::Reference>(&expression.node); reference != nullptr && reference->primes == 0)
    return reference->name.text;
  if (auto const* text = std::get_if<ast::Text>(&expression.node)) return text->value;
  return std::nullopt;
}

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
        scope_(graph_, diagnostics, {}) {}

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
    bool const errors = diagnostics_.all().size() > before_;
    if (errors || unresolved_) return std::nullopt;
    return task;
  }

 private:
  // --- references
  // -----------------------------------------------------------------------------------------------------------------
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

  void data(int& index, int& part, Model const* model, std::string const& preposition) {
    if (!tree_.data) {
      diagnostics_.add(errors::data_missing(tree_, preposition));
      return;
    }
    auto const found = item(tree_.data->data, names_.data, "data block");
    if (!found) return;
    index = *found;
    DataBlock const& block = file_.data[static_cast<std::size_t>(index)];
    if (tree_.data->part) {
      auto const place = std::find_if(block.parts.begin(), block.parts.end(),
                                      [&](DataPart const& each) { return each.name == tree_.data->part->text; });
      if (place == block.parts.end()) {
        std::vector<std::string> known;
        for (DataPart const& each : block.parts) known.push_back(each.name);
        diagnostics_.add(errors::unknown_member(*tree_.data->part, "data `" + block.name + "`", "part", known));
        return;
      }
      part = static_cast<int>(place - block.parts.begin());
    }
    if (model != nullptr) check_binding(block, *model, tree_.data->span, diagnostics_);
  }

  // --- numbers
  // --------------------------------------------------------------------------------------------------------------------
  // unit: absent where nothing is declared, and anything goes.
  std::optional<double> number(ast::Expression const& tree, std::string const& name, std::optional<Unit> const& unit, double least,
                               double most, bool whole = false) {
    auto const value = scope_.expression(tree);
    if (!value) return std::nullopt;
    if (unit && value->kind == Typed::Kind::known && value->unit.dimension != unit->dimension) {
      diagnostics_.add(errors::number_of_other_kind(tree.span, "`" + name + "`", value->unit, *unit));
      return std::nullopt;
    }
    auto const constant = graph_.constant_value(adapt(graph_, *value, unit));
    if (!constant) {
      diagnostics_.add(errors::constant_needed(tree.span, "`" + name + "`"));
      return std::nullopt;
    }
    if (whole && *constant != std::floor(*constant)) {
      diagnostics_.add(
          errors::option_kind(tree.span, name, "a whole number", fmt::format("{} = {:.0f}", name, std::round(*constant))));
      return std::nullopt;
    }
    if (!(*constant >= least && *constant <= most)) {
      diagnostics_.add(errors::option_range(tree.span, name, *constant, least, most));
      return std::nullopt;
    }
    return constant;
  }
  void whole(ast::Option const& option, std::string const& name, double least, double most, int& place) {
    if (auto const value = number(option.value, name, Unit{}, least, most, true)) place = static_cast<int>(*value);
  }
  void seed(ast::Option const& option, std::optional<std::uint64_t>& place) {
    if (auto const value = number(option.value, "seed", Unit{}, 0, 9007199254740992.0, true))
      place = static_cast<std::uint64_t>(*value);
  }

  void start(ast::Option const& option, StartRule& rule) {
    std::vector<std::string> const choices = {"record", "rest", "estimated"};
    if (ast::Call const* call = as_call(option.value)) {
      if (call->function.text == "estimated") {
        rule = {StartRule::Kind::estimated, default_start_rows};
        for (ast::Argument const& argument : call->arguments) {
          if (argument.name && argument.name->text != "rows") {
            diagnostics_.add(errors::unknown_argument(*argument.name, "estimated", {"rows"}));
          } else if (auto const rows = number(argument.value, "rows", Unit{}, 2, 1e9, true)) {
            rule.rows = static_cast<int>(*rows);
          }
        }
        return;
      }
      diagnostics_.add(errors::option_choice(option.value.span, "start", call->function.text, choices));
      return;
    }
    auto const word = as_word(option.value);
    if (word == "record") {
      rule = {StartRule::Kind::record, 0};
    } else if (word == "rest") {
      rule = {StartRule::Kind::rest, 0};
    } else if (word == "estimated") {
      rule = {StartRule::Kind::estimated, default_start_rows};
    } else {
      diagnostics_.add(errors::option_choice(option.value.span, "start", word.value_or("this"), choices));
    }
  }

  void unknown(ast::Option const& option, std::vector<std::string> const& known) {
    std::string const key = key_of(option);
    diagnostics_.add(errors::unknown_option(option.key ? option.key->span : head_span(option.value), key.empty() ? "this" : key,
                                            tree_.verb.text, known));
  }
  bool fresh(ast::Option const& option, std::string const& key) {
    auto const [place, is_fresh] = seen_.emplace(option.input ? "input " + key : key, option.span);
    std::string const what = key == the_backend ? key : "`" + place->first + "`";
    if (!is_fresh) diagnostics_.add(errors::stated_twice(option.span, place->second, what));
    return is_fresh;
  }

  // A table of settings against `name(key = value, ...)`.
  void settings(ast::Call const& call, std::span<SettingRow const> rows, Settings& values) {
    std::vector<std::string> known;
    for (SettingRow const& row : rows) known.emplace_back(row.name);
    std::map<std::string, Span> given;
    for (ast::Argument const& argument : call.arguments) {
      if (!argument.name) {
        diagnostics_.add(
            errors::must_be_named(argument.span, call.function.text, known.empty() ? std::vector<std::string>{""} : known));
        continue;
      }
      std::string const& name = argument.name->text;
      auto const row = std::find_if(rows.begin(), rows.end(), [&](SettingRow const& each) { return each.name == name; });
      if (row == rows.end()) {
        diagnostics_.add(errors::unknown_option(argument.name->span, name, call.function.text, known));
        continue;
      }
      if (auto const [place, is_fresh] = given.emplace(name, argument.span); !is_fresh) {
        diagnostics_.add(errors::stated_twice(argument.span, place->second, "`" + name + "`"));
        continue;
      }
      switch (row->kind) {
        case SettingKind::integer:
          if (auto const value = number(argument.value, name, Unit{}, row->minimum, row->maximum, true))
            values.set(name, static_cast<std::int64_t>(*value));
          break;
        case SettingKind::real:
          if (auto const value = number(argument.value, name, Unit{}, row->minimum, row->maximum)) values.set(name, *value);
          break;
        case SettingKind::flag: {
          auto const word = as_word(argument.value);
          if (word == "yes" || word == "no")
            values.set(name, word == "yes");
          else
            diagnostics_.add(errors::option_choice(argument.value.span, name, word.value_or("this"), {"yes", "no"}));
          break;
        }
        case SettingKind::word: {
          std::vector<std::string> choices;
          std::istringstream stream{std::string(row->choices)};
          for (std::string choice; stream >> choice;) choices.push_back(choice);
          auto const word = as_word(argument.value);
          if (word && std::find(choices.begin(), choices.end(), *word) != choices.end())
            values.set(name, *word);
          else
            diagnostics_.add(errors::option_choice(argument.value.span, name, word.value_or("this"), choices));
          break;
        }
      }
    }
  }

  // --- the verbs
  // ------------------------------------------------------------------------------------------------------------------
  FitTask fit() {
    FitTask task;
    std::vector<std::string> names;
    for (BackendSettings const& backend : backends_) names.emplace_back(backend.name);
    auto const model = item(tree_.subject, names_.models, "model");
    if (model) task.model = *model;
    data(task.data, task.part, model ? &file_.models[static_cast<std::size_t>(*model)] : nullptr, "to");
    for (ast::Option const& option : tree_.options) {
      std::string const key = key_of(option);
      auto const backend = std::find_if(backends_.begin(), backends_.end(), [&](auto const& each) { return each.name == key; });
      if (!option.input && !option.key && backend != backends_.end()) {
        if (!fresh(option, the_backend)) continue;
        task.backend = key;
        task.settings = Settings(backend->settings);
        if (ast::Call const* call = as_call(option.value)) settings(*call, backend->settings, task.settings);
      } else if (!option.input && option.key && key == "start") {
        if (fresh(option, key)) start(option, task.start);
      } else if (!option.input && option.key && key == "substeps") {
        if (fresh(option, key) && as_word(option.value) != "automatic") whole(option, key, 1, 10000, task.substeps);
      } else if (!option.input && option.key && key == "seed") {
        if (fresh(option, key)) seed(option, task.seed);
      } else if (!option.input && !option.key && !key.empty()) {
        diagnostics_.add(errors::unknown_backend({{head_span(option.value)}, key}, names));
        task.backend = key;  // said once is enough
      } else {
        unknown(option, {"start", "substeps", "seed"});
      }
    }
    if (task.backend.empty() && diagnostics_.all().size() == before_) diagnostics_.add(errors::backend_missing(tree_, names));
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
    data(task.data, task.part, model, "on");
    for (ast::Option const& option : tree_.options) {
      std::string const key = key_of(option);
      if (option.input || !fresh(option, key)) {
        if (option.input) unknown(option, {"draws", "redraw", "start", "seed"});
        continue;
      }
      if (key == "draws") {
        ast::Call const* call = as_call(option.value);
        ast::Expression const* count = option.key                                       ? &option.value
                                       : call != nullptr && call->arguments.size() == 1 ? &call->arguments[0].value
                                                                                        : nullptr;
        if (count == nullptr)
          diagnostics_.add(errors::option_kind(option.span, "draws", "a number of posterior draws", "draws(200)"));
        else if (auto const value = number(*count, "draws", Unit{}, 1, 1e7, true))
          task.draws = static_cast<int>(*value);
      } else if (option.key && key == "redraw") {
        auto const word = as_word(option.value);
        if (word == "trajectory" || word == "step")
          task.redraw_each_step = word == "step";
        else
          diagnostics_.add(errors::option_choice(option.value.span, key, word.value_or("this"), {"trajectory", "step"}));
      } else if (option.key && key == "start") {
        start(option, task.start);
      } else if (option.key && key == "seed") {
        seed(option, task.seed);
      } else {
        unknown(option, {"draws", "redraw", "start", "seed"});
      }
    }
    return task;
  }

  struct GeneratorArgument {
    std::string_view name;
    std::string_view unit;  // of its own; "input": that of the input
    double fallback;        // NaN: needed
  };
  struct GeneratorRow {
    std::string_view name;
    InputGenerator::Kind kind;
    std::vector<GeneratorArgument> arguments;
    InputRule rule;
  };
  static std::vector<GeneratorRow> const& generators() {
    double const needed = std::nan("");
    static std::vector<GeneratorRow> const rows = {
        {"gaussian", InputGenerator::Kind::gaussian, {{"mean", "input", 0}, {"sd", "input", needed}}, InputRule::zero_order},
        {"sine",
         InputGenerator::Kind::sine,
         {{"amplitude", "input", needed}, {"frequency", "Hz", needed}, {"phase", "", 0}, {"mean", "input", 0}},
         InputRule::cubic},
        {"multisine",
         InputGenerator::Kind::multisine,
         {{"sd", "input", needed}, {"lowest", "Hz", needed}, {"highest", "Hz", needed}, {"mean", "input", 0}},
         InputRule::band_limited},
        {"constant", InputGenerator::Kind::constant, {{"value", "input", needed}}, InputRule::zero_order},
    };
    return rows;
  }

  std::optional<InputGenerator> generator(ast::Option const& option, Quantity const& input) {
    ast::Call const* call = as_call(option.value);
    std::vector<std::string> names;
    for (GeneratorRow const& row : generators()) names.emplace_back(row.name);
    if (call == nullptr) {
      diagnostics_.add(errors::option_kind(option.value.span, "input " + input.name, "a generated signal", "gaussian(sd = 10)"));
      return std::nullopt;
    }
    auto const row =
        std::find_if(generators().begin(), generators().end(), [&](auto const& each) { return each.name == call->function.text; });
    if (row == generators().end()) {
      diagnostics_.add(errors::option_choice(call->function.span, "input " + input.name, call->function.text, names));
      return std::nullopt;
    }
    InputGenerator result{row->kind, {}, row->rule};
    std::map<std::string, Span> given;  // rightly or not
    std::vector<std::string> known;
    for (GeneratorArgument const& argument : row->arguments) known.emplace_back(argument.name);
    known.emplace_back("hold");
    for (ast::Argument const& argument : call->arguments) {
      std::string const name = argument.name ? argument.name->text : "";
      auto const place =
          std::find_if(row->arguments.begin(), row->arguments.end(), [&](auto const& each) { return each.name == name; });
      if (!argument.name) {
        diagnostics_.add(errors::must_be_named(argument.span, call->function.text, known));
      } else if (name == "hold") {
        std::vector<std::string> const rules = {"zero_order", "linear", "cubic", "band_limited"};
        auto const word = as_word(argument.value);
        auto const rule = std::find(rules.begin(), rules.end(), word.value_or(""));
        if (rule == rules.end())
          diagnostics_.add(errors::option_choice(argument.value.span, name, word.value_or("this"), rules));
        else
          result.rule = static_cast<InputRule>(rule - rules.begin());
      } else if (place == row->arguments.end()) {
        diagnostics_.add(errors::unknown_argument(*argument.name, call->function.text, known));
      } else {
        if (auto const [first, is_fresh] = given.emplace(name, argument.span); !is_fresh) {
          diagnostics_.add(errors::stated_twice(argument.span, first->second, "`" + name + "`"));
          continue;
        }
        std::optional<Unit> const unit = place->unit == "input" ? input.unit : unit_of(place->unit);
        double const least = name == "mean" || name == "value" || name == "phase" ? -1e300 : 0;
        if (auto const value = number(argument.value, name, unit, least, 1e300)) result.arguments[name] = *value;
      }
    }
    for (GeneratorArgument const& argument : row->arguments) {
      if (given.contains(std::string(argument.name))) continue;
      if (std::isnan(argument.fallback))
        diagnostics_.add(errors::argument_missing(*call, {std::string(argument.name)}));
      else
        result.arguments[std::string(argument.name)] = argument.fallback;
    }
    return result;
  }

  // The names that states, channel locations and (when the model makes the noise) noise need.
  std::vector<std::string> values_needed(Model const& model, SimulateTask const& task) const {
    std::vector<NodeId> roots;
    for (State const& state : model.states) roots.insert(roots.end(), {state.derivative, state.initial});
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
    if (tree_.data) diagnostics_.add(errors::data_unused(tree_, tree_.data->span));
    auto const found = item(tree_.subject, names_.models, "model");
    if (!found) return task;
    task.model = *found;
    Model const& model = file_.models[static_cast<std::size_t>(*found)];
    task.values.resize(model.parameters.size());
    task.inputs.resize(model.inputs.size());
    std::vector<bool> given(model.inputs.size(), false);
    std::vector<Span> places(model.inputs.size());
    std::vector<std::string> const options = {"values", "input", "noise", "samples", "rate", "step", "substeps", "seed", "file"};
    for (ast::Option const& option : tree_.options) {
      std::string const key = key_of(option);
      if (!fresh(option, key)) continue;
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
        if (auto generated = generator(option, *place)) task.inputs[index] = std::move(*generated);
      } else if (key == "values" && as_call(option.value) != nullptr) {
        values(*as_call(option.value), model, task);
      } else if (option.key && key == "noise") {
        if (as_word(option.value) == "model")
          task.noise_fraction = -1;
        else if (auto const value = number(option.value, key, unit_of("percent"), 0, 1e6))
          task.noise_fraction = *value;
      } else if (option.key && key == "samples") {
        whole(option, key, 2, 1e8, task.samples);
      } else if (option.key && (key == "rate" || key == "step")) {
        if (auto const value = number(option.value, key, unit_of(key == "rate" ? "Hz" : "s"), 1e-300, 1e300))
          task.step = key == "rate" ? 1 / *value : *value;
      } else if (option.key && key == "substeps") {
        whole(option, key, 1, 10000, task.substeps);
      } else if (option.key && key == "seed") {
        seed(option, task.seed);
      } else if (option.key && key == "file") {
        if (auto const* text = std::get_if<ast::Text>(&option.value.node);
            text != nullptr && text->value.find('/') == std::string::npos)
          task.file = text->value;
        else
          diagnostics_.add(
              errors::option_kind(option.value.span, key, "a file name in quotes, without folders", "file = \"truth.csv\""));
      } else {
        unknown(option, options);
      }
    }
    if (task.file.empty()) task.file = task_name(tree_) + ".csv";
    if (diagnostics_.all().size() > before_) return task;
    if (task.samples == 0) diagnostics_.add(errors::option_missing(tree_, "samples", "samples = 500"));
    if (task.step == 0) diagnostics_.add(errors::option_missing(tree_, "rate", "rate = 1000 [Hz]"));
    for (std::size_t i = 0; i < given.size(); ++i)
      if (!given[i])
        diagnostics_.add(errors::option_missing(tree_, "input " + model.inputs[i].name,
                                                "input " + model.inputs[i].name + " = gaussian(sd = 1)"));
    if (auto const missing = values_needed(model, task); !missing.empty())
      diagnostics_.add(errors::value_missing(tree_.verb.span, missing));
    if (task.samples > 0 && task.step > 0)
      for (std::size_t i = 0; i < given.size(); ++i)
        if (given[i]) check_band(task.inputs[i], task, places[i]);
    return task;
  }

  // A multisine has a harmonic k/(samples*step) in its band, and none at or above half the rate.
  void check_band(InputGenerator const& generator, SimulateTask const& task, Span place) {
    if (generator.kind != InputGenerator::Kind::multisine) return;
    double const lowest = generator.arguments.at("lowest"), highest = generator.arguments.at("highest");
    double const resolution = 1 / (task.samples * task.step);
    if (highest >= 0.5 / task.step) {
      diagnostics_.add(errors::multisine_beyond_half_rate(place, highest, 0.5 / task.step));
      return;
    }
    double const last = std::floor(highest / resolution);
    if (last < 1 || last * resolution < lowest)
      diagnostics_.add(errors::multisine_without_harmonic(place, lowest, highest, resolution));
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
      std::optional<Unit> const& unit = model.parameters[index].unit;
      if (auto const value = number(argument.value, argument.name->text, unit, -1e300, 1e300)) task.values[index] = *value;
    }
  }

  ast::Task const& tree_;
  TaskNames const& names_;
  CheckedFile const& file_;
  std::span<BackendSettings const> backends_;
  std::span<ast::Task const* const> all_tasks_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  Graph graph_;
  Scope scope_;
  bool unresolved_ = false;
  std::map<std::string, Span> seen_;
};

}  // namespace

std::string task_name(ast::Task const& tree) { return tree.name ? tree.name->text : tree.verb.text + "_" + tree.subject.text; }

std::optional<Task> check_task(ast::Task const& tree, TaskNames const& names, CheckedFile const& file,
                               std::span<BackendSettings const> backends, std::span<ast::Task const* const> all_tasks,
                               Diagnostics& diagnostics) {
  return TaskChecker(tree, names, file, backends, all_tasks, diagnostics).run();
}

}  // namespace sysid
