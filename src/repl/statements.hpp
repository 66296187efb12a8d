// How the statements of an entry are handled.
#pragma once
#include <string>

#include "repl/context.hpp"

namespace sysid::repl {

/// Takes in statements, runs those that are tasks and answers expressions. False when one failed: the work is then what it was
/// before that one.
bool enter_statements(Context& context, std::string const& entry);

/// Checks a draft and makes it the work, or shows what is wrong with it. entry: what was typed; empty where nothing was.
bool adopt(Context& context, Workspace draft, std::string const& entry);

}  // namespace sysid::repl
