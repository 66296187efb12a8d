// What was found, written as equations: "m*y'' - x = -20*y' - 1e4*y".
#pragma once
#include <string>
#include <vector>

#include "check/checked/checked.hpp"

namespace sysid {

/// A term of an equation's dictionary with a coefficient in its declared unit.
struct PrintedTerm {
  std::size_t term = 0;
  double coefficient = 0, sd = 0;
};

/// With as many digits as the sds leave; terms that stand in the target are left out.
std::string equation_text(DictionaryEquation const& equation, std::vector<PrintedTerm> const& terms);

}  // namespace sysid
