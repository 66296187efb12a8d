// Which messages merely follow from others.
#pragma once
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// Removes errors that another error of the same file explains: the same unknown name again in its model; what an equation or an
/// initial value with an unknown name leaves open; a missing argument beside one with an unknown name. At least one error stays.
void remove_cascades(ast::File const& file, Diagnostics& diagnostics);

}  // namespace sysid
