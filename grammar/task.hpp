// Tasks.
#pragma once
#include "grammar/expression.hpp"

namespace sysid::grammar {

struct task_tag {};

inline constexpr x3::rule<task_tag, ast::Task> task = "a task";

BOOST_SPIRIT_DECLARE(decltype(task))

}  // namespace sysid::grammar
