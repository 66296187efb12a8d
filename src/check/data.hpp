// A data block of the syntax tree to a checked one: which file, which columns in which units, how inputs run between samples,
// splits.
#pragma once
#include <optional>

#include "check/checked.hpp"
#include "core/diagnostic.hpp"
#include "syntax/ast.hpp"

namespace sysid {

std::optional<DataBlock> check_data(ast::Data const& tree, Diagnostics& diagnostics);

/// Whether the block serves a model: every input bound, some channel measured, no unknown channel, units of one kind, input
/// derivatives only where they exist. use: the place of the task that brings the two together.
void check_binding(DataBlock const& block, Model const& model, Span use, Diagnostics& diagnostics);

}  // namespace sysid
