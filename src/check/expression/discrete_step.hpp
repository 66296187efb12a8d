// The time between samples that a model or a dictionary in discrete time declares.
#pragma once
#include <optional>

#include "check/expression/scope.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// [s], positive. Nothing where it is left to the data, or after a diagnostic.
std::optional<double> declared_step(ast::DiscreteTimeDeclaration const& discrete, Scope& scope);

}  // namespace sysid
