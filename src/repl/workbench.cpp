// An entry is a command, or statements.
#include "repl/workbench.hpp"

#include "core/system/interrupt.hpp"
#include "core/text/words.hpp"
#include "repl/commands.hpp"
#include "repl/statements.hpp"
#include "repl/words.hpp"
#include "syntax/entry.hpp"

namespace sysid::repl {

Workbench::Workbench(RunOptions options, Progress& progress, Voices voices)
    : context_{std::move(options), progress, Output(std::move(voices))} {
  context_.options.figures = false;
  context_.options.surface = Surface::prompt;
}

bool Workbench::complete(std::string const& entry) const {
  std::string arguments;
  return command_of(entry, arguments) != nullptr || !unfinished(entry);
}

bool Workbench::enter(std::string const& entry) {
  clear_interrupt();  // a request of before was for work of before
  std::string arguments;
  if (CommandRow const* row = command_of(std::string(trimmed(entry)), arguments))
    return context_.output.guarded(Source("prompt", arguments), [&] { return row->run(context_, arguments); });
  return context_.output.guarded(Source("prompt", entry), [&] { return enter_statements(context_, entry); });
}

}  // namespace sysid::repl
