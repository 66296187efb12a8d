// What a verb of the command line is made of: options to declare, then work to do.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

#include "cli/messages.hpp"

namespace sysid::cli {

/// Done once the options are read.
using Work = std::function<ExitCode(Messages const&)>;

/// A verb: its name, the group it stands in on the page of all, what it does in a line, how its options are declared, and commands
/// as one would type them, one a line.
struct Command {
  char const *name, *group, *summary;
  Work (*declare)(CLI::App& verb);
  char const* examples;
  bool by_ranks = false;  // processes that mpirun starts do it together; all else is done by the first of them
};

/// Each adds a verb's options to `verb`; the work that it returns owns their values.
Work declare_tasks(CLI::App& verb);  // run, or the one kind of task that the verb is named after
Work declare_data(CLI::App& verb);
Work declare_check(CLI::App& verb);
Work declare_calibrate(CLI::App& verb);
Work declare_crosscheck(CLI::App& verb);
Work declare_track(CLI::App& verb);
Work declare_repl(CLI::App& verb);
Work declare_compare(CLI::App& verb);
Work declare_report(CLI::App& verb);
Work declare_export(CLI::App& verb);
Work declare_format(CLI::App& verb);
Work declare_list(CLI::App& verb);
Work declare_explain(CLI::App& verb);
Work declare_document(CLI::App& verb);
Work declare_lsp(CLI::App& verb);
Work declare_version(CLI::App& verb);
Work declare_manual(CLI::App& verb);
Work declare_completion(CLI::App& verb);

/// "sysid 1.2 (AVX-512, Open MPI v4.1.4)" and a line end.
std::string version_text();

}  // namespace sysid::cli
