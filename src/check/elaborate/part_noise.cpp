// Finds the statements that only the noise of parts needs, by following definitions to their uses.
#include "check/elaborate/part_noise.hpp"

#include <map>
#include <utility>

#include "core/text/without_index.hpp"
#include "syntax/walk.hpp"

namespace sysid {
namespace {

using Statements = std::map<std::string, std::vector<ast::ModelStatement const*>>;

/// The name of a parameter or definition: what it says is there for those that read it. Empty for other statements.
std::string dispensable(ast::ModelStatement const& statement) {
  if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement)) return parameter->name.name.text;
  auto const* definition = std::get_if<ast::Definition>(&statement);
  return definition == nullptr || definition->kind == ast::DefinitionKind::derived ? std::string() : definition->name.name.text;
}

/// Adds what the statements behind the names read, and those behind that; `as`: how a name is written in the set.
template <class Spelling>
void spread(std::set<std::string>& names, Statements const& behind, Spelling const& as) {
  std::vector<std::string> open(names.begin(), names.end());
  while (!open.empty()) {
    auto const place = behind.find(open.back());
    open.pop_back();
    if (place == behind.end()) continue;
    for (ast::ModelStatement const* statement : place->second)
      each_reference(*statement, [&](ast::Reference const& reference) {
        std::string name = as(reference.name.text);
        if (names.insert(name).second) open.push_back(std::move(name));
      });
  }
}

}  // namespace

void drop_noise_of_parts(std::vector<ast::ModelStatement>& statements, std::set<std::string> noise) {
  Statements whole, single;
  for (ast::ModelStatement const& statement : statements)
    if (std::string const name = dispensable(statement); !name.empty()) {
      whole[without_index(name)].push_back(&statement);
      single[name].push_back(&statement);
    }
  spread(noise, whole, without_index);
  auto const of_noise = [&](std::string const& name) {
    return name.find('.') != std::string::npos && noise.contains(without_index(name));
  };
  std::set<std::string> kept;  // names of numbers
  for (ast::ModelStatement const& statement : statements)
    if (!of_noise(dispensable(statement)))
      each_reference(statement, [&](ast::Reference const& reference) { kept.insert(reference.name.text); });
  spread(kept, single, [](std::string const& name) { return name; });
  std::erase_if(statements, [&](ast::ModelStatement const& statement) {
    std::string const name = dispensable(statement);
    return of_noise(name) && !kept.contains(name);
  });
}

}  // namespace sysid
