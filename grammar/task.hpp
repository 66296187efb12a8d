// Tasks.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

inline constexpr x3::rule<struct task_tag, ast::Task> task = "a task";

BOOST_SPIRIT_DECLARE(decltype(task))

}  // namespace sysid::grammar
