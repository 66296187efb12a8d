// Which models a file needs and with which arguments: those of tasks, of candidates, of parts, and some of each model for its own
// check.
#include "check/elaborate/elaborate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "check/elaborate/candidates.hpp"
#include "check/elaborate/dictionary_functions.hpp"
#include "check/elaborate/divided_power.hpp"
#include "check/elaborate/flatten.hpp"
#include "check/elaborate/frame.hpp"
#include "check/elaborate/tree.hpp"
#include "check/message/errors_reuse.hpp"
#include "syntax/words.hpp"

namespace sysid {
namespace {

// All models together, each with each of its arguments.
constexpr std::size_t most_nodes_of_file = 1'000'000;

class Elaborator {
 public:
  Elaborator(ast::File const& file, std::vector<Module> const& modules, Diagnostics& diagnostics)
      : file_(file), diagnostics_(diagnostics), environments_(file, modules, diagnostics) {}

  Elaborated run() {
    for (ast::Item const& item : file_.items)
      if (auto const* model = std::get_if<ast::Model>(&item); model != nullptr && model->arguments.empty() && is_first(*model))
        request({{model, &environments_.main()}, {}}, false);
    std::vector<ast::Item> others;
    for (ast::Item const& item : file_.items) {
      if (auto const* task = std::get_if<ast::Task>(&item))
        others.push_back(elaborated(*task));
      else if (auto const* set = std::get_if<ast::Candidates>(&item))
        others.push_back(elaborated(*set));
      else if (auto const* dictionary = std::get_if<ast::Dictionary>(&item))
        others.push_back(with_functions(*dictionary, environments_.main()));
      else if (!std::holds_alternative<ast::Model>(item) && !std::holds_alternative<ast::Use>(item))
        others.push_back(item);
    }
    for (auto const& [module, environment] : environments_.all())
      if (!environment.from_library)
        for (auto const& [name, model] : environment.models)
          if (model.home == &environment) check_alone(model);
    result_.tree.items.insert(result_.tree.items.end(), std::make_move_iterator(others.begin()),
                              std::make_move_iterator(others.end()));
    return std::move(result_);
  }

 private:
  bool is_first(ast::Model const& model) const { return environments_.main().models.at(model.name.text).tree == &model; }

  // As the file knows it, else with the module before it.
  std::string name_of(Instance const& instance) const {
    auto const& visible = environments_.main().models;
    auto const place = visible.find(instance.model.tree->name.text);
    bool const known = place != visible.end() && place->second.tree == instance.model.tree;
    return known ? instance.display() : instance.model.home->module + "." + instance.display();
  }

  /// The name under which tasks find it; made on the first request.
  std::string request(Instance const& instance, bool only_checked) {
    std::string const name = name_of(instance);
    if (made_.contains(name)) {
      if (!only_checked) result_.lineage.only_checked.erase(name);
      return name;
    }
    made_.insert(name);
    std::vector<std::string>& made_of = result_.lineage.made_of[name];
    // With other arguments the same text has the same mistakes.
    auto const [first, fresh] = first_instance_.emplace(instance.model.tree, name);
    if (!fresh) made_of.push_back(first->second);
    for (Instance const& part : parts_of(instance))
      if (!part.model.home->from_library) made_of.push_back(request(part, true));
    bool const sound = std::none_of(made_of.begin(), made_of.end(),
                                    [&](std::string const& each) { return result_.lineage.failed.contains(each); });
    if (left_ == 0 && !result_.lineage.failed.contains(name) && !std::exchange(said_too_large_, true))
      diagnostics_.add(errors::models_too_large(instance.model.tree->name.span));
    auto flat = sound && left_ > 0 ? flatten(instance, left_, diagnostics_) : std::nullopt;
    if (flat) {
      flat->tree.name.text = name;
      result_.tree.items.emplace_back(std::move(flat->tree));
      shapes_[name] = std::move(flat->shapes);
    } else {
      result_.lineage.failed.insert(name);
    }
    if (only_checked) result_.lineage.only_checked.insert(name);
    return name;
  }

  // A model that nothing uses: with the defaults of its arguments, else with 1, 2 and 3 for each.
  void check_alone(ModelEntry const& model) {
    if (first_instance_.contains(model.tree)) return;
    std::vector<ast::Argument> given;
    Diagnostics none;
    if (model_arguments(*model.tree, given, model.tree->name.span, {}, none)) {
      request({model, *model_arguments(*model.tree, given, model.tree->name.span, {}, none)}, true);
      return;
    }
    for (int const value : {1, 2, 3}) {
      given.clear();
      for (ast::ModelArgument const& argument : model.tree->arguments)
        if (!argument.value) given.push_back({{argument.span}, argument.name, tree::number(value, argument.span)});
      if (auto arguments = model_arguments(*model.tree, given, model.tree->name.span, {}, diagnostics_))
        request({model, std::move(*arguments)}, true);
    }
  }

  // The subject becomes the model with its arguments; what is given for a vector is given for each of its numbers.
  ast::Task elaborated(ast::Task task) {
    auto const model = environments_.main().models.find(task.subject.text);
    if (words::task_kind(task.verb.text) == TaskKind::predict || model == environments_.main().models.end()) return task;
    std::size_t const before = diagnostics_.all().size();
    auto const arguments = model_arguments(*model->second.tree, task.arguments, task.subject.span, {}, diagnostics_);
    check_names(*model->second.tree, task.arguments);
    if (diagnostics_.all().size() > before || !arguments) {
      result_.lineage.failed.insert(task.subject.text);
      return task;
    }
    std::string const plain = task.subject.text;
    task.subject.text = request({model->second, *arguments}, false);
    task.arguments.clear();
    if (!task.name && task.subject.text != plain) {
      std::string name = task.verb.text + "_" + plain;  // the name of a folder: fit_bouc_wen_n2
      for (ast::ModelArgument const& argument : model->second.tree->arguments)
        name += fmt::format("_{}{}", argument.name.text, arguments->at(argument.name.text));
      task.name = {{task.verb.span}, std::move(name)};
    }
    if (auto const shapes = shapes_.find(task.subject.text); shapes != shapes_.end()) spread(task, shapes->second);
    return task;
  }

  // Each candidate becomes the models it stands for, under their names and without arguments; one that failed keeps its own.
  ast::Candidates elaborated(ast::Candidates set) {
    std::vector<ast::CandidateStatement> statements;
    std::map<std::string, Shape> shapes;
    for (ast::CandidateStatement& statement : set.statements) {
      auto* candidate = std::get_if<ast::Candidate>(&statement);
      auto const model =
          candidate == nullptr ? environments_.main().models.end() : environments_.main().models.find(candidate->model.text);
      if (model == environments_.main().models.end()) {
        statements.push_back(std::move(statement));
        continue;
      }
      auto const names = requested(model->second, *candidate);
      if (names.empty()) {
        result_.lineage.failed.insert(candidate->model.text);
        statements.push_back(std::move(statement));
        continue;
      }
      candidate->arguments.clear();
      for (std::string const& name : names) {
        candidate->model.text = name;
        statements.emplace_back(*candidate);
        if (auto const known = shapes_.find(name); known != shapes_.end())
          shapes.insert(known->second.begin(), known->second.end());
      }
    }
    for (ast::CandidateStatement& statement : statements) {
      auto* shared = std::get_if<ast::SharedParameters>(&statement);
      if (shared == nullptr) continue;
      std::vector<ast::Name> names;
      for (ast::Name const& name : shared->names) {
        auto const shape = shapes.find(name.text);
        if (shape == shapes.end()) names.push_back(name);
        for (std::size_t i = 0; shape != shapes.end() && i < shape->second.count(); ++i)
          names.push_back({{name.span}, element_name(name.text, shape->second, i)});
      }
      shared->names = std::move(names);
    }
    set.statements = std::move(statements);
    return set;
  }

  // Empty when a diagnostic was added.
  std::vector<std::string> requested(ModelEntry const& model, ast::Candidate const& candidate) {
    std::size_t const before = diagnostics_.all().size();
    check_names(*model.tree, candidate.arguments);
    auto const all = expanded(candidate.arguments, diagnostics_);
    std::vector<std::string> names;
    for (std::size_t i = 0; all && i < all->size() && diagnostics_.all().size() == before; ++i)
      if (auto arguments = model_arguments(*model.tree, (*all)[i], candidate.model.span, {}, diagnostics_))
        names.push_back(request({model, std::move(*arguments)}, false));
    return names;
  }

  void check_names(ast::Model const& model, std::vector<ast::Argument> const& arguments) {
    errors::Names known;
    for (ast::ModelArgument const& argument : model.arguments) known.push_back(argument.name.text);
    std::map<std::string, Span> given;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
      ast::Argument const& argument = arguments[i];
      if (!argument.name) {
        diagnostics_.add(errors::model_argument_by_position(arguments, i, model.name.text, known));
      } else if (std::find(known.begin(), known.end(), argument.name->text) == known.end()) {
        diagnostics_.add(errors::unknown_model_argument(*argument.name, model.name.text, known));
      } else if (auto const [first, fresh] = given.emplace(argument.name->text, argument.name->span); !fresh) {
        diagnostics_.add(errors::model_argument_twice(argument.name->span, first->second, argument.name->text));
      }
    }
  }

  // `input u = gaussian(sd = 1)` and `values(k = (1, 2, 3))` for vectors.
  void spread(ast::Task& task, std::map<std::string, Shape> const& shapes) {
    std::vector<ast::Option> options;
    for (ast::Option& option : task.options) {
      auto const shape = option.input && option.key ? shapes.find(option.key->text) : shapes.end();
      if (shape != shapes.end()) {
        for (std::size_t i = 0; i < shape->second.count(); ++i) {
          options.push_back(option);
          options.back().key->text = element_name(option.key->text, shape->second, i);
        }
        continue;
      }
      auto* call = std::get_if<ast::Box<ast::Call>>(&option.value.node);
      if (call != nullptr && (*call)->function.text == "values") spread(**call, shapes);
      options.push_back(std::move(option));
    }
    task.options = std::move(options);
  }
  void spread(ast::Call& values, std::map<std::string, Shape> const& shapes) {
    static ast::Model const nothing;
    Frame frame;
    frame.instance.model = {&nothing, &environments_.main()};
    Evaluator evaluator(diagnostics_, 100'000);
    std::vector<ast::Argument> arguments;
    for (ast::Argument& argument : values.arguments) {
      auto const shape = argument.name ? shapes.find(argument.name->text) : shapes.end();
      if (shape == shapes.end()) {
        arguments.push_back(std::move(argument));
        continue;
      }
      auto value = evaluator.evaluate(argument.value, frame);
      if (value)
        value = evaluator.algebra().fill(std::move(*value), shape->second, true, errors::named("the value of", shape->first),
                                         argument.value.span);
      if (!value) continue;
      for (std::size_t i = 0; i < value->items.size(); ++i)
        arguments.push_back({{argument.span},
                             ast::Name{{argument.name->span}, element_name(argument.name->text, shape->second, i)},
                             std::move(value->items[i])});
    }
    values.arguments = std::move(arguments);
  }

  ast::File const& file_;
  Diagnostics& diagnostics_;
  Environments environments_;
  Elaborated result_;
  std::size_t left_ = most_nodes_of_file;
  bool said_too_large_ = false;
  std::set<std::string> made_;
  std::map<ast::Model const*, std::string> first_instance_;
  std::map<std::string, std::map<std::string, Shape>> shapes_;
};

}  // namespace

Elaborated elaborate(ast::File const& file, std::vector<Module> const& modules, Diagnostics& diagnostics) {
  refuse_divided_powers(file, diagnostics);
  return Elaborator(file, modules, diagnostics).run();
}

}  // namespace sysid
