// The names in statements of models and dictionaries, one function for each kind of statement.
#include <map>
#include <optional>
#include <string>
#include <variant>

#include "assist/use_resolver.hpp"
#include "check/expression/option_reader.hpp"

namespace sysid::assist {

void UseResolver::declared(ast::Declared const& tree, Place const& place) {
  for (ast::Expression const& size : tree.sizes) expression(size, place);
  unit(tree.unit, place);
}

void UseResolver::statement(ast::InitialDeclaration const& each, Place const& place) {
  for (ast::InitialValue const& initial : each.values) {
    reference(initial.state, place);
    if (initial.value) expression(*initial.value, place);
    if (initial.law) word_call(*initial.law, WordKind::distribution, place);
  }
}
void UseResolver::statement(ast::DisturbanceDeclaration const& each, Place const& place) {
  declared(each.name, place);
  bool const law = find_word(WordKind::law, each.law.function.text) != nullptr;
  word_call(each.law, law ? WordKind::law : WordKind::distribution, place);
}
void UseResolver::statement(ast::ParameterDeclaration const& each, Place const& place) {
  declared(each.name, place);
  if (each.prior) word_call(*each.prior, WordKind::distribution, place);
  if (each.value) expression(*each.value, place);
}
void UseResolver::statement(ast::Definition const& each, Place const& place) {
  declared(each.name, place);
  expression(each.value, place);
}
void UseResolver::statement(ast::FunctionDefinition const& each, Place const& place) {
  if (auto const symbol = place.scope->functions.find(each.name.text); symbol != place.scope->functions.end())
    function(each, symbol->second, place);
}
void UseResolver::statement(ast::ProcessDefinition const& each, Place const& place) {
  auto const symbol = place.scope->functions.find(each.name.text);
  if (symbol == place.scope->functions.end()) return;
  std::map<std::string, int> inputs;
  for (ast::Name const& input : each.inputs)
    inputs.emplace(input.text, table_.declare(SymbolKind::function_argument, input, each.span, symbol->second));
  for (ast::Argument const& argument : each.process.arguments) covariance(argument.value, each, inputs, place);
}
void UseResolver::covariance(ast::Expression const& tree, ast::ProcessDefinition const& process,
                             std::map<std::string, int> const& inputs, Place const& place) {
  if (auto const* binary = std::get_if<ast::Box<ast::Binary>>(&tree.node)) {
    covariance(*(*binary)->left, process, inputs, place);
    covariance(*(*binary)->right, process, inputs, place);
    return;
  }
  ast::Call const* kernel = as_call(tree);
  if (kernel == nullptr) return;
  if (Word const* known = find_word(WordKind::kernel, kernel->function.text)) word(kernel->function.span, *known);
  for (ast::Argument const& argument : kernel->arguments) {
    if (argument.name) {
      setting(*argument.name, kernel->function.text);
      expression(argument.value, place);
    } else if (auto const* input = std::get_if<ast::Reference>(&argument.value.node)) {
      if (auto const known = inputs.find(input->name.text); known != inputs.end()) table_.mention(input->name.span, known->second);
    }
  }
}
void UseResolver::statement(ast::Observation const& each, Place const& place) {
  declared(each.channel, place);
  word_call(each.noise, WordKind::distribution, place);
}
void UseResolver::statement(ast::Part const& each, Place const& place) {
  auto const entry = place.home->models.find(each.model.function.text);
  if (entry == place.home->models.end()) {
    for (ast::Argument const& argument : each.model.arguments) expression(argument.value, place);
    return;
  }
  NameScope const& inner = models.at(entry->second.tree);
  table_.mention(each.model.function.span, inner.symbol);
  if (auto const own = place.scope->quantities.find(each.name.text); own != place.scope->quantities.end())
    table_[own->second].refers = inner.symbol;
  arguments_of_model(each.model.arguments, {&inner});
  for (ast::Argument const& argument : each.model.arguments) expression(argument.value, place);
}
void UseResolver::statement(ast::Equation const& each, Place const& place) {
  expression(each.left, place);
  expression(each.right, place);
}
void UseResolver::statement(ast::DictionaryStates const& each, Place const& place) {
  for (ast::DictionaryState const& state : each.states) unit(state.unit, place);
}
void UseResolver::statement(ast::DictionaryParameter const& each, Place const& place) {
  declared(each.name, place);
  if (each.prior) word_call(*each.prior, WordKind::distribution, place);
  if (each.value) expression(*each.value, place);
}
void UseResolver::statement(ast::DictionaryList const& each, Place const& place) {
  for (ast::Expression const& item : each.items) expression(item, place);
}
void UseResolver::statement(ast::CoefficientUnits const& each, Place const& place) {
  for (ast::UnitExpression const& one : each.units) unit(one, place);
}

void UseResolver::function(ast::FunctionDefinition const& tree, int symbol, Place place) {
  std::map<std::string, int> locals;
  for (ast::Name const& parameter : tree.parameters)
    locals.emplace(parameter.text, table_.declare(SymbolKind::function_argument, parameter, tree.span, symbol));
  place.locals = &locals;
  expression(tree.value, place);
}

void UseResolver::walk(ast::Model const& model) {
  NameScope const& scope = models.at(&model);
  Place place;
  place.scope = &scope;
  place.home = scope.home;
  place.calls = &calls_of_scopes_[&scope];
  for (ast::ModelArgument const& argument : model.arguments)
    if (argument.value) expression(*argument.value, place);
  for (ast::ModelStatement const& each : model.statements) std::visit([&](auto const& one) { statement(one, place); }, each);
}

void UseResolver::walk(ast::Dictionary const& dictionary) {
  NameScope const& scope = dictionaries.at(&dictionary);
  Place place;
  place.scope = &scope;
  place.home = scope.home;
  place.calls = &calls_of_scopes_[&scope];
  for (ast::DictionaryStatement const& each : dictionary.statements)
    std::visit([&](auto const& one) { statement(one, place); }, each);
}

void UseResolver::walk(ast::FunctionDefinition const& tree, Environment const& home) {
  Place place;
  place.home = &home;
  place.shared = &tree;
  place.calls = &calls_of_functions_[&tree];
  function(tree, functions.at(&tree), place);
}

void UseResolver::distribution(ast::Call const& call, Environment const& home) {
  Place place;
  place.home = &home;
  word_call(call, WordKind::distribution, place);
}
void UseResolver::plain(ast::Expression const& tree, Environment const& home) {
  Place place;
  place.home = &home;
  expression(tree, place);
}

}  // namespace sysid::assist
