// Model blocks, and function definitions, which may also stand in a file.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

inline constexpr x3::rule<struct model_tag, ast::Model> model = "a model";
inline constexpr x3::rule<struct function_definition_tag, ast::FunctionDefinition> function_definition = "a function definition";

BOOST_SPIRIT_DECLARE(decltype(model), decltype(function_definition))

}  // namespace sysid::grammar
