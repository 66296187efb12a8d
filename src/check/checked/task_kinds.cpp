// The table of the kinds of tasks.
#include "check/checked/task_kinds.hpp"

#include <type_traits>
#include <variant>

namespace sysid {
namespace {

template <TaskKind kind, typename What>
constexpr bool is_at = std::is_same_v<std::variant_alternative_t<static_cast<std::size_t>(kind), decltype(Task::what)>, What>;
static_assert(is_at<TaskKind::simulate, SimulateTask> && is_at<TaskKind::fit, FitTask> && is_at<TaskKind::select, SelectTask> &&
              is_at<TaskKind::discover, DiscoverTask> && is_at<TaskKind::predict, PredictTask>);
static_assert(static_cast<std::size_t>(TaskKind::predict) + 1 == task_kind_count && words::verbs.size() == task_kind_count);

constexpr std::string_view verb_of_kind(TaskKind kind) { return words::verbs[static_cast<std::size_t>(kind)]; }

}  // namespace

std::span<TaskKindRow const> task_kinds() {
  static constexpr TaskKindRow rows[] = {
      {.kind = TaskKind::simulate, .verb = verb_of_kind(TaskKind::simulate), .preposition = ""},
      {.kind = TaskKind::fit, .verb = verb_of_kind(TaskKind::fit), .preposition = "to", .has_draws = true},
      {.kind = TaskKind::select, .verb = verb_of_kind(TaskKind::select), .preposition = "to", .has_draws = true},
      {.kind = TaskKind::discover, .verb = verb_of_kind(TaskKind::discover), .preposition = "from"},
      {.kind = TaskKind::predict, .verb = verb_of_kind(TaskKind::predict), .preposition = "on"},
  };
  return rows;
}

TaskKindRow const& row_of(TaskKind kind) { return task_kinds()[static_cast<std::size_t>(kind)]; }

TaskKindRow const* find_task_kind(std::string_view verb) {
  auto const kind = words::task_kind(verb);
  return kind ? &row_of(*kind) : nullptr;
}

TaskKind kind_of(Task const& task) { return static_cast<TaskKind>(task.what.index()); }

std::string verb_of(Task const& task) { return std::string(row_of(kind_of(task)).verb); }

std::optional<std::uint64_t> stated_seed(Task const& task) {
  return std::visit([](auto const& what) { return what.seed; }, task.what);
}

}  // namespace sysid
