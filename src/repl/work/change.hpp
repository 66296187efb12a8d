// Statements typed at the prompt put into a block of the work: each takes the place of what had its name, or is added.
#pragma once
#include <string>

#include "repl/work/workspace.hpp"

namespace sysid::repl {

/// block: a model or data block. entry, span: what was typed, and where in it one statement of such a block stands. A declaration
/// replaces that of the same name, an equation the one for the same highest derivatives (the only one, where there is one for one
/// state); what is listed under one word, as inputs or parts of a split, is replaced one by one.
WorkItem with_statement(WorkItem block, std::string const& entry, Span span);

/// Without the declaration of a name or, of a model, the equation whose text is `what`; the same block when there is none.
WorkItem without_statement(WorkItem block, std::string const& what);

}  // namespace sysid::repl
