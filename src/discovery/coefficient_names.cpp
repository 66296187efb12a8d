// Names of coefficients that collide with no name of the dictionary.
#include "discovery/coefficient_names.hpp"

#include <fmt/format.h>

#include <map>

namespace sysid {

std::set<std::string> declared_names(CheckedDictionary const& dictionary) {
  std::set<std::string> names;
  for (Quantity const& state : dictionary.states) names.insert(state.name);
  for (ast::DictionaryStatement const& statement : dictionary.tree.statements) {
    if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement)) names.insert(time->time.name.text);
    if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement))
      for (ast::Declared const& input : inputs->names) names.insert(input.name.text);
    if (auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement)) names.insert(parameter->name.name.text);
    if (auto const* definition = std::get_if<ast::Definition>(&statement)) names.insert(definition->name.name.text);
  }
  return names;
}

std::vector<std::string> coefficient_names(CheckedDictionary const& dictionary, int equation) {
  std::set<std::string> const declared = declared_names(dictionary);
  std::vector<DictionaryTerm> const& terms = dictionary.equations[static_cast<std::size_t>(equation)].terms;
  std::map<std::string, int> before;  // how many terms a parameter stands before, in all equations
  for (DictionaryEquation const& each : dictionary.equations)
    for (DictionaryTerm const& term : each.terms) ++before[term.coefficient];
  std::vector<std::string> names;
  int index = 0;
  for (DictionaryTerm const& term : terms) {
    if (!term.in_target) ++index;
    if (!term.coefficient.empty() && before[term.coefficient] == 1) {
      names.push_back(term.coefficient);
      continue;
    }
    std::string const letter(1, static_cast<char>('a' + equation % 26));
    std::string name = fmt::format("{}{}{}", letter, equation < 26 ? "" : fmt::format("{}_", equation / 26), index);
    while (declared.contains(name)) name += "_";
    names.push_back(std::move(name));
  }
  return names;
}

}  // namespace sysid
