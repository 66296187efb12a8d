// The identity of an error, to compare the errors of a model that is checked again with another unit; units in a message may
// change.
#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <tuple>

#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Of a model that is checked again, for the time it takes.
constexpr std::size_t most_statements = 200;

using Mistake = std::tuple<std::string, std::uint32_t, std::uint32_t>;

Mistake mistake_of(Diagnostic const& each);
/// About names, numbers and units: what may follow from a unit. Mistakes of structure come to light when those before are gone.
std::set<Mistake> mistakes_from(std::size_t first, Diagnostics const& diagnostics);
/// Takes these mistakes out, of those from `first` on, and adds one in their place that is made of the earliest of them.
void replace_resolved(Diagnostics& diagnostics, std::size_t first, std::set<Mistake> const& resolved,
                      std::function<Diagnostic(Diagnostic earliest)> const& in_their_place);

template <class Visit>
void each_declared(ast::Model& model, Visit const& visit) {
  for (ast::ModelStatement& statement : model.statements) {
    if (auto* inputs = std::get_if<ast::InputDeclaration>(&statement))
      for (ast::Declared& input : inputs->names) visit(input);
    if (auto* states = std::get_if<ast::StateDeclaration>(&statement))
      for (ast::Declared& state : states->names) visit(state);
    if (auto* disturbance = std::get_if<ast::DisturbanceDeclaration>(&statement)) visit(disturbance->name);
    if (auto* parameter = std::get_if<ast::ParameterDeclaration>(&statement)) visit(parameter->name);
    if (auto* definition = std::get_if<ast::Definition>(&statement)) visit(definition->name);
    if (auto* observation = std::get_if<ast::Observation>(&statement)) visit(observation->channel);
  }
}

}  // namespace sysid
