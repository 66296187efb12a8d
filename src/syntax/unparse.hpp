// Syntax tree to canonical text: parse(unparse(tree)) == tree. Serves `--dump ast` and messages.
#pragma once
#include <string>

#include "syntax/ast.hpp"

namespace sysid {

std::string unparse(ast::File const& file);
std::string unparse(ast::ModelStatement const& statement);
std::string unparse(ast::Expression const& expression);
std::string unparse(ast::UnitExpression const& unit);

}  // namespace sysid
