// Running tasks of the work.
#pragma once
#include <memory>
#include <string>

#include "repl/context.hpp"

namespace sysid::repl {

/// Runs a task of a checked text and keeps its result. False when it could not be run.
bool run_task(Context& context, std::string const& name, std::shared_ptr<CheckedText const> const& checked, bool resume);
/// The text of a task with a seed, so that the file that is saved gives the same numbers.
std::string with_seed(Context const& context, std::string const& task);
/// "fit2" after "fit1": no statement and no folder of results has it.
std::string free_task_name(Context const& context, std::string const& like);
/// The fit of the work that was run last; empty when there is none.
std::string last_fit(Context const& context);

}  // namespace sysid::repl
