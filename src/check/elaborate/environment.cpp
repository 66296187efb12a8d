// Names of files: first everybody's own, then what they take over from the modules they use.
#include "check/elaborate/environment.hpp"

#include "check/message/errors_reuse.hpp"

namespace sysid {

Environments::Environments(ast::File const& file, std::vector<Module> const& modules, Diagnostics& diagnostics) {
  own(all_[""], file, diagnostics);
  for (Module const& module : modules) {
    Environment& environment = all_[module.name];
    environment.module = module.name;
    environment.from_library = module.from_library;
    own(environment, module.tree, diagnostics);
  }
  import(all_[""], file, diagnostics);
  for (Module const& module : modules) import(all_[module.name], module.tree, diagnostics);
}

void Environments::own(Environment& environment, ast::File const& tree, Diagnostics& diagnostics) {
  for (ast::Item const& item : tree.items) {
    if (auto const* model = std::get_if<ast::Model>(&item)) {
      auto const [place, fresh] = environment.models.emplace(model->name.text, ModelEntry{model, &environment});
      if (!fresh) diagnostics.add(errors::duplicate_item(model->name, "model", place->second.tree->name.span));
    } else if (auto const* function = std::get_if<ast::FunctionDefinition>(&item)) {
      auto const [place, fresh] = environment.functions.emplace(function->name.text, FunctionEntry{function, &environment});
      if (!fresh) diagnostics.add(errors::duplicate_item(function->name, "function", place->second.tree->name.span));
    } else if (auto const* data = std::get_if<ast::Data>(&item); data != nullptr && !environment.module.empty()) {
      diagnostics.add(errors::not_for_a_module(data->name.span, "a data block", environment.module));
    } else if (auto const* dictionary = std::get_if<ast::Dictionary>(&item); dictionary != nullptr && !environment.module.empty()) {
      diagnostics.add(errors::not_for_a_module(dictionary->name.span, "a dictionary", environment.module));
    } else if (auto const* task = std::get_if<ast::Task>(&item); task != nullptr && !environment.module.empty()) {
      diagnostics.add(errors::not_for_a_module(task->verb.span, "a task", environment.module));
    }
  }
}

void Environments::import(Environment& environment, ast::File const& tree, Diagnostics& diagnostics) {
  for (ast::Item const& item : tree.items) {
    auto const* use = std::get_if<ast::Use>(&item);
    auto const used = use == nullptr ? all_.end() : all_.find(use->module.text);
    if (used == all_.end() || &used->second == &environment) continue;  // not found: said where it was looked for
    for (auto const& [name, model] : used->second.models) {
      if (model.home != &used->second) continue;  // what a module uses is its own affair
      auto const [place, fresh] = environment.models.emplace(name, model);
      if (!fresh && place->second.tree != model.tree)
        diagnostics.add(errors::name_of_two_modules(place->second.tree->name.span, model.tree->name.span, "model", name));
    }
    for (auto const& [name, function] : used->second.functions) {
      if (function.home != &used->second) continue;
      auto const [place, fresh] = environment.functions.emplace(name, function);
      if (!fresh && place->second.tree != function.tree)
        diagnostics.add(errors::name_of_two_modules(place->second.tree->name.span, function.tree->name.span, "function", name));
    }
  }
}

}  // namespace sysid
