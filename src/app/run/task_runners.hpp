// How each kind of task is run: one row for each.
#pragma once
#include <span>
#include <string>

#include "app/session/session.hpp"
#include "check/checked/task_kinds.hpp"

namespace sysid {

struct TaskRunner {
  TaskKind kind;
  /// index: of the task in its file.
  ExitCode (*run)(Session&, int index, Task const&);
  /// Whether its folder holds what it makes, from an earlier run.
  bool (*complete)(Session const&, Task const&);
  /// A task of this kind that the file could have, so that the line can be copied.
  std::string (*example)(CheckedFile const&);
};

std::span<TaskRunner const> task_runners();
TaskRunner const& task_runner(TaskKind kind);

}  // namespace sysid
