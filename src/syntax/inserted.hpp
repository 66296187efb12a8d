// Statements into which numbers have been put for the arguments of a model, as a reader expects them: what a zero takes out is
// gone.
#pragma once
#include "syntax/ast.hpp"

namespace sysid {

/// `m*y'' + 0*k2*y^2 + 1*k3*y^3 = x` as `m*y'' + k3*y^3 = x`: terms and factors that are zero, factors and exponents that are one.
/// Equal in value wherever the terms taken out are finite; for people alone.
ast::ModelStatement without_idle_terms(ast::ModelStatement statement);

}  // namespace sysid
