// The kinds of tasks, once: what every room that treats them differently has a table over. The checker's table is in check/task, of
// what tasks read in app/session, of the checks before they run in app/preflight, of running them in app/run.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>

#include "check/checked/checked.hpp"
#include "core/text/diagnostic.hpp"
#include "syntax/words.hpp"

namespace sysid {

/// TaskKind has the order of the alternatives of Task::what.
inline constexpr std::size_t task_kind_count = std::variant_size_v<decltype(Task::what)>;

struct TaskKindRow {
  TaskKind kind;
  std::string_view verb;         // that a task is written with
  std::string_view preposition;  // before its data; empty: it reads none
  bool has_draws = false;        // a prediction may carry its draws
};

/// One row for each TaskKind, in its order.
std::span<TaskKindRow const> task_kinds();
TaskKindRow const& row_of(TaskKind kind);
/// nullptr when there is none of that verb.
TaskKindRow const* find_task_kind(std::string_view verb);

TaskKind kind_of(Task const& task);
/// "fit": the verb that a task is written with.
std::string verb_of(Task const& task);
/// The seed that the task states.
std::optional<std::uint64_t> stated_seed(Task const& task);

/// The row for `kind` in a table with one row per kind, in any order.
template <typename Rows>
auto const& row_for(Rows const& rows, TaskKind kind) {
  for (auto const& row : rows)
    if (row.kind == kind) return row;
  throw InternalError("a kind of task without a row");
}

}  // namespace sysid
