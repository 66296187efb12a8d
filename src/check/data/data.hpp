// A data block of the syntax tree to a checked one: which file, which columns in which units, how inputs run between samples,
// splits.
#pragma once
#include <optional>

#include "check/checked/checked.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

std::optional<DataBlock> check_data(ast::Data const& tree, Diagnostics& diagnostics);

}  // namespace sysid
