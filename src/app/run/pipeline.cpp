// Runs the wanted tasks of a checked file in order, each by the row of its kind (task_runners.cpp). `load` (load/load.cpp) has
// taken the text to that file: parse, modules, elaborate, check.
#include "app/run/pipeline.hpp"

#include <algorithm>

#include "app/run/nothing_to_do.hpp"
#include "app/session/session.hpp"
#include "check/checked/task_kinds.hpp"

namespace sysid {

ExitCode run_tasks(Source const& source, CheckedFile const& file, std::vector<std::string> const& verbs, RunOptions const& options,
                   Progress& progress, std::ostream& out, std::ostream& notices) {
  Session session(source, file, options, progress, out, notices);
  auto const asked = [&](Task const& task) {
    return verbs.empty() || std::find(verbs.begin(), verbs.end(), verb_of(task)) != verbs.end();
  };
  if (options.execution.executor == ExecutorKind::native)
    if (std::string const why = why_no_machine_code(); !why.empty())
      notices << "machine code is not available, simulations are interpreted: " << why << '\n';
  if (std::any_of(file.tasks.begin(), file.tasks.end(), asked)) return run_tasks(session, asked);
  notices << nothing_to_do(source, file, verbs);
  return ExitCode::usage;
}

}  // namespace sysid
