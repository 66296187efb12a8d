// The names that equations read, through definitions and functions.
#pragma once
#include <functional>
#include <set>

#include "check/expression/scope.hpp"
#include "syntax/ast.hpp"
#include "syntax/walk.hpp"

namespace sysid {

/// The names an equation uses, directly or through definitions and functions. Visits each definition and function once.
class NamesUsed {
 public:
  NamesUsed(Scope const& scope, std::function<void(ast::Reference const&)> visit) : scope_(scope), visit_(std::move(visit)) {}

  void of(ast::Equation const& equation) {
    of(equation.left);
    of(equation.right);
  }
  void of(ast::Expression const& tree) {
    each_expression(tree, [&](ast::Expression const& part) {
      if (auto const* reference = std::get_if<ast::Reference>(&part.node))
        read(*reference);
      else if (auto const* call = std::get_if<ast::Box<ast::Call>>(&part.node))
        enter(**call);
    });
  }

 private:
  void read(ast::Reference const& reference) {
    visit_(reference);
    Symbol const* symbol = scope_.find(reference.name.text);
    auto const* definition = symbol == nullptr ? nullptr : std::get_if<DefinitionSymbol>(&symbol->what);
    if (definition != nullptr && seen_.insert(definition->definition).second) of(definition->definition->value);
  }
  void enter(ast::Call const& call) {
    ast::FunctionDefinition const* function = scope_.find_function_definition(call.function.text);
    if (function != nullptr && seen_.insert(function).second) of(function->value);
  }

  Scope const& scope_;
  std::function<void(ast::Reference const&)> visit_;
  std::set<void const*> seen_;
};

}  // namespace sysid
