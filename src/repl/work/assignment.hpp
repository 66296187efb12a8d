// `k = 5` at the prompt: to the language an equation, which would take the place of one of the model.
#pragma once
#include <optional>
#include <string>

#include "core/text/diagnostic.hpp"
#include "repl/work/workspace.hpp"

namespace sysid::repl {

/// Refuses a statement of a model, [begin, end) of an entry, that gives a value to a single name which is no state of it.
std::optional<Diagnostic> assignment(WorkItem const& model, std::string const& entry, Span span);

}  // namespace sysid::repl
