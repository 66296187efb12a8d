// Syntax trees to a table of names, by the scoping rules of the compiler (check/elaborate/environment.hpp, frame.hpp): it also
// stands where the checker finds mistakes. What cannot be resolved is left out.
#pragma once
#include <span>

#include "assist/symbols.hpp"
#include "check/elaborate/environment.hpp"

namespace sysid::assist {

/// file, modules: of one Source, whose spans the table has; the file need not be free of mistakes.
SymbolTable resolve(ast::File const& file, std::vector<Module> const& modules);

}  // namespace sysid::assist
