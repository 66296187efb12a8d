// `sysid repl`: entries from a terminal, with editing, history and completion, or line by line from a pipe.
#pragma once
#include <istream>
#include <string>

#include "app/session/options.hpp"
#include "core/system/progress.hpp"
#include "repl/workbench.hpp"

namespace sysid::repl {

/// Entries of a stream, which are not repeated in the answers and have no prompt. Goes on behind one that fails. Exit code: 0, or 1
/// when one has failed.
int read_entries(std::istream& in, Workbench& workbench);

/// The dialogue in a terminal, to its end: on standard input and output, with the history of earlier ones. 0.
int talk(Workbench& workbench);

/// Standard input, a terminal or not; file: loaded first, where it is not empty.
int run_prompt(RunOptions const& options, std::string const& file);

}  // namespace sysid::repl
