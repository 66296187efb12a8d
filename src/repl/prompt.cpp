// A pipe, or a terminal; and what is not saved at the end.
#include "repl/prompt.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <iostream>

#include "core/system/colour.hpp"
#include "core/system/files.hpp"
#include "core/system/progress_terminal.hpp"
#include "core/text/wrapped.hpp"
#include "repl/state.hpp"

namespace sysid::repl {
namespace {

/// Nobody means to lose an hour's work by Ctrl-D.
void keep_unsaved(Workbench const& workbench) {
  std::filesystem::path const folder = state_folder();
  if (!workbench.unsaved() || folder.empty()) return;
  Workspace work = workbench.work();
  std::filesystem::path const path = folder / "unsaved.sysid";
  work.move_to(path);
  try {
    write_file(path, work.text());
    std::cerr << fmt::format("the session was not saved; a copy is in {}\n", path.string());
  } catch (IoError const&) {
    // There is nothing better to do with it.
  }
}

}  // namespace

int read_entries(std::istream& in, Workbench& workbench) {
  bool failed = false;
  std::string entry;
  for (std::string line; !workbench.over() && std::getline(in, line);) {
    entry += line + '\n';
    if (!workbench.complete(entry)) continue;
    failed = !workbench.enter(entry) || failed;
    entry.clear();
  }
  if (!entry.empty() && !workbench.over()) failed = !workbench.enter(entry) || failed;
  return failed ? 1 : 0;
}

int run_prompt(RunOptions const& options, std::string const& file) {
  TerminalProgress progress;
  LineOutput messages(std::cerr, wrapped_for(STDERR_FILENO));
  Workbench workbench(options, progress,
                      {std::cout, messages, coloured_messages(), [] { return terminal_columns(STDOUT_FILENO); }});
  bool const terminal = isatty(STDIN_FILENO) != 0;
  // Without anybody at the prompt there is nothing to go on with.
  if (!terminal && !file.empty()) (void)read_file(file, 1);
  bool const loaded = file.empty() || workbench.enter("load \"" + file + "\"");
  if (!terminal) {
    int const exit = read_entries(std::cin, workbench);
    return loaded ? exit : 1;
  }
  int const exit = talk(workbench);
  keep_unsaved(workbench);
  return exit;
}

}  // namespace sysid::repl
