// All functions of the language, one row each, in the order `sysid list functions` prints.
#pragma once
#include <span>
#include <string_view>

#include "expression/function.hpp"

namespace sysid {

std::span<FunctionRow const> functions();
/// nullptr when there is none of that name.
FunctionRow const* find_function(std::string_view name);

}  // namespace sysid
