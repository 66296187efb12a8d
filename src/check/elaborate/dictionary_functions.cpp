// Follows calls from the dictionary's lists and definitions, each function once.
#include "check/elaborate/dictionary_functions.hpp"

#include <map>
#include <set>
#include <string>
#include <utility>

#include "syntax/walk.hpp"

namespace sysid {
namespace {

template <class Visit>
void each_call(auto& tree, Visit const& visit) {
  each_expression(tree, [&](auto& part) {
    if (auto* call = std::get_if<ast::Box<ast::Call>>(&part.node)) visit(**call);
  });
}

/// The expressions of a dictionary's statements that may call functions, its own functions included.
template <class Visit>
void each_top(ast::Dictionary const& dictionary, Visit const& visit) {
  for (ast::DictionaryStatement const& statement : dictionary.statements) {
    if (auto const* definition = std::get_if<ast::Definition>(&statement)) visit(definition->value);
    if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) visit(function->value);
    if (auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement)) {
      if (parameter->value) visit(*parameter->value);
      if (parameter->prior)
        for (ast::Argument const& argument : parameter->prior->arguments) visit(argument.value);
    }
    if (auto const* list = std::get_if<ast::DictionaryList>(&statement))
      for (ast::Expression const& item : list->items) visit(item);
  }
}

class Bringer {
 public:
  Bringer(ast::Dictionary const& dictionary, Environment const& file) : file_(file) {
    for (ast::DictionaryStatement const& statement : dictionary.statements)
      if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) own_.insert(function->name.text);
  }

  /// What the file's text calls: names of its own mean themselves.
  void follow(ast::Expression const& tree) {
    each_call(tree, [&](ast::Call const& call) {
      auto const found = file_.functions.find(call.function.text);
      if (own_.contains(call.function.text) || found == file_.functions.end() || !seen_.insert(found->second.tree).second) return;
      if (found->second.home == &file_)
        follow(found->second.tree->value);
      else
        bring(found->second);
    });
  }

  std::vector<ast::FunctionDefinition> brought;

 private:
  std::string const& name_of(FunctionEntry const& function) {
    std::string& name = names_[function.tree];
    if (!name.empty()) return name;
    name = function.tree->name.text;
    auto const visible = file_.functions.find(name);
    if (visible != file_.functions.end() && visible->second.tree == function.tree && !own_.contains(name)) return name;
    name = function.home->module + "_" + name;
    while (own_.contains(name) || file_.functions.contains(name)) name += "_";
    own_.insert(name);
    return name;
  }

  // In the module's text names mean what they mean there.
  void bring(FunctionEntry const& function) {
    ast::FunctionDefinition copy = *function.tree;
    copy.name.text = name_of(function);
    each_call(copy.value, [&](ast::Call& call) {
      auto const found = function.home->functions.find(call.function.text);
      if (found == function.home->functions.end()) return;
      call.function.text = name_of(found->second);
      if (seen_.insert(found->second.tree).second) bring(found->second);
    });
    brought.push_back(std::move(copy));
  }

  Environment const& file_;
  std::set<std::string> own_;  // names that functions of the dictionary have
  std::set<ast::FunctionDefinition const*> seen_;
  std::map<ast::FunctionDefinition const*, std::string> names_;
};

}  // namespace

ast::Dictionary with_functions(ast::Dictionary dictionary, Environment const& file) {
  Bringer bringer(dictionary, file);
  each_top(dictionary, [&](ast::Expression const& tree) { bringer.follow(tree); });
  for (ast::FunctionDefinition& function : bringer.brought) dictionary.statements.emplace_back(std::move(function));
  return dictionary;
}

}  // namespace sysid
