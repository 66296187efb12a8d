// One model of the syntax tree to a checked, first-order model.
#pragma once
#include <optional>
#include <vector>

#include "core/text/diagnostic.hpp"
#include "model/model.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// shared: functions defined at the top of the file. Nothing when a diagnostic was added.
std::optional<Model> check_model(ast::Model const& tree, std::vector<ast::FunctionDefinition const*> const& shared,
                                 Diagnostics& diagnostics);

}  // namespace sysid
