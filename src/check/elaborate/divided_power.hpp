// `y^1/3` is `(y^1)/3`: what nobody means.
#pragma once
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Refuses powers of 1, as they are written, that a whole number divides. `y^2/3` may be meant.
void refuse_divided_powers(ast::File const& file, Diagnostics& diagnostics);

}  // namespace sysid
