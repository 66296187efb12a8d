// Runs the requested tasks of a file in order: complete results are kept, and none is replaced before all tasks can begin.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "app/run/pipeline.hpp"
#include "app/run/task_runners.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/session/session.hpp"

namespace sysid {

ExitCode run_tasks(Session& session, std::function<bool(Task const&)> const& asked) {
  CheckedFile const& file = session.file;
  RunOptions const& options = session.options;
  auto const kept = [&](Task const& task) {
    if (!task_runner(kind_of(task)).complete(session, task)) return false;
    if (kind_of(task) == TaskKind::simulate) return true;  // it leaves its record, and nothing that could be compared
    std::optional<std::uint64_t> const seed = options.seed ? options.seed : stated_seed(task);
    if (auto wrong = stored_otherwise(session, task, seed); wrong && options.resume) {
      wrong->primary = Label{task.span, {}};
      throw UserError(*wrong);
    }
    return true;
  };
  std::set<Task const*> complete_already;
  for (Task const& task : file.tasks)
    if (asked(task) && options.resume && kept(task)) complete_already.insert(&task);
  auto const wanted = [&](Task const& task) { return asked(task) && !complete_already.contains(&task); };
  check_preconditions(session, wanted).require();  // before old results are touched
  for (Task const& task : file.tasks) {
    if (!wanted(task)) continue;
    if (kind_of(task) == TaskKind::simulate && kept(task) && !options.force)
      throw UserError(
          result_error("", fmt::format("`{}` holds results already", session.result_folder(task).string()), replace_results()));
    claim_results(session.result_folder(task), options);
  }
  ExitCode worst = ExitCode::success;
  for (std::size_t i = 0; i < file.tasks.size(); ++i) {
    Task const& task = file.tasks[i];
    if (complete_already.contains(&task)) session.notices << fmt::format("{}: complete, kept\n", task.name);
    if (!wanted(task)) continue;
    ExitCode const code = task_runner(kind_of(task)).run(session, static_cast<int>(i), task);
    if (code == ExitCode::interrupted) return code;
    worst = std::max(worst, code);
  }
  return worst;
}

}  // namespace sysid
