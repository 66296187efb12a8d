// A dictionary of the syntax tree to a discovery problem in numbers: generators written out, equal terms merged, units kept at
// hand.
#pragma once
#include <optional>
#include <vector>

#include "check/checked/checked.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

std::optional<CheckedDictionary> check_dictionary(ast::Dictionary const& tree,
                                                  std::vector<ast::FunctionDefinition const*> const& functions,
                                                  Diagnostics& diagnostics);

}  // namespace sysid
