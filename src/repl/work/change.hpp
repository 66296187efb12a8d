// Statements typed at the prompt put into a block of the work: each takes the place of what had its name, or is added.
#pragma once
#include <string>
#include <vector>

#include "repl/work/workspace.hpp"

namespace sysid::repl {

/// block: a model or data block. entry, span: what was typed, and where in it one statement of such a block stands. A declaration
/// replaces that of the same name, an equation the one for the same highest derivatives (the only one, where there is one for one
/// state); what is listed under one word, as inputs or parts of a split, is replaced one by one.
WorkItem with_statement(WorkItem block, std::string const& entry, Span span);

/// A parameter that was declared in a unit, by a statement that another without one has replaced, also `let` with a bare number:
/// its numbers mean others now.
struct LostUnit {
  std::string parameter, unit;
};
std::vector<LostUnit> lost_units(WorkItem const& before, WorkItem const& after);

/// Without what `what` names: its declaration; where it has none, its observation or initial value; of a model, the equation whose
/// text it is but for blanks. The same block when there is none, or when it stands in a list with others.
WorkItem without_statement(WorkItem block, std::string const& what);

}  // namespace sysid::repl
