// Runs the requested tasks of a file in order: complete results are kept, and all that can be refused is refused before
// the first begins.
#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <vector>

#include "app/run/pipeline.hpp"
#include "app/run/task_runners.hpp"
#include "app/session/preconditions.hpp"
#include "app/session/reporting.hpp"
#include "app/session/results.hpp"
#include "app/session/session.hpp"
#include "app/session/stored_draws.hpp"
#include "app/session/task_rows.hpp"
#include "core/ranks/ranks.hpp"
#include "core/system/files.hpp"
#include "core/system/interrupt.hpp"
#include "report/file/replacement.hpp"

namespace sysid {
namespace {

ExitCode run_or_stop(Session& session, int index, Task const& task) {
  try {
    return task_runner(kind_of(task)).run(session, index, task);
  } catch (Interrupted const&) {
    // What holds a complete result of before is not begun by going on.
    if (task_runner(kind_of(task)).complete(session, task))
      session.notices << fmt::format("{}: interrupted; its earlier results are kept\n", task.name);
    else
      session.notices << fmt::format("{}: interrupted; {} starts it again\n", task.name, to_resume(session.options.surface));
    return ExitCode::interrupted;
  } catch (IoError const& error) {  // a full disk leaves the last checkpoint whole
    if (files_are_left() || !std::filesystem::exists(checkpoint_path(session.result_folder(task)))) throw;
    throw IoError(error.what(), fmt::format("{}{}the last checkpoint is kept: {} continues from there", error.help(),
                                            error.help().empty() ? "" : "; ", to_resume(session.options.surface)));
  }
}

/// What a task has written may be read by the next, by ranks on other nodes too: to open the folder has network file systems look.
void read_after_leader(std::filesystem::path const& folder) {
  ranks::wait_for_all();
  if (std::error_code ignored; files_are_left()) std::filesystem::directory_iterator const looked(folder, ignored);
}

ExitCode run_claimed(Session& session, std::function<bool(Task const&)> const& asked) {
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
  // What a killed run had ready is put in its place before anyone looks.
  for (Task const& task : file.tasks) (void)summary_stands(session.result_folder(task));
  ranks::wait_for_all();
  std::set<Task const*> complete_already;
  for (Task const& task : file.tasks)
    if (asked(task) && options.resume && kept(task)) complete_already.insert(&task);
  auto const wanted = [&](Task const& task) { return asked(task) && !complete_already.contains(&task); };
  check_preconditions(session, wanted).require();
  // What was stored by earlier runs is read before anything begins, as the data are.
  for (Task const& task : file.tasks)
    for (int const index : wanted(task) ? task_row(task).needs(task) : std::vector<int>()) {
      Task const& needed = file.tasks[static_cast<std::size_t>(index)];
      if (wanted(needed)) continue;
      if (kind_of(needed) == TaskKind::select)
        selected_candidates(session, index);
      else
        fitted_model(session, index);
    }
  ranks::wait_for_all();  // before anything is written where another rank reads
  ClaimedFolders claimed;
  for (Task const& task : file.tasks) {
    if (!wanted(task)) continue;
    if (kind_of(task) == TaskKind::simulate && kept(task) && !options.force)
      throw UserError(
          result_error("", fmt::format("`{}` already contains results", session.result_folder(task).string()), replace_results()));
    claimed.folders.emplace_back(session.result_folder(task), options);
  }
  ExitCode worst = ExitCode::success;
  for (std::size_t i = 0; i < file.tasks.size(); ++i) {
    Task const& task = file.tasks[i];
    if (complete_already.contains(&task)) worst = std::max(worst, keep_complete(session, task));
    if (!wanted(task)) continue;
    ExitCode const code = run_or_stop(session, static_cast<int>(i), task);
    if (code == ExitCode::interrupted) return code;
    remove_file(checkpoint_path(session.result_folder(task)));  // that of an earlier run, which this result replaces
    worst = std::max(worst, code);
    read_after_leader(session.result_folder(task));
  }
  return worst;
}

}  // namespace

ExitCode run_tasks(Session& session, std::function<bool(Task const&)> const& asked) {
  try {
    return run_claimed(session, asked);
  } catch (Interrupted const&) {
    session.notices << "interrupted while the data were read\n";
    return ExitCode::interrupted;
  }
}

}  // namespace sysid
