// Functions of modules that a dictionary calls, copied into it: later stages have no modules.
#pragma once
#include "check/elaborate/environment.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// The dictionary with the functions of modules that it calls, by itself or through functions of the file, as statements of its
/// own. What those call within their modules comes with them, under a name that is not taken where the file cannot see it.
ast::Dictionary with_functions(ast::Dictionary dictionary, Environment const& file);

}  // namespace sysid
