// Tasks of the syntax tree to checked ones: what they refer to, their options against tables, units of numbers.
#pragma once
#include <map>
#include <optional>
#include <span>
#include <string>

#include "check/checked/backends.hpp"
#include "check/checked/checked.hpp"
#include "check/data/binding.hpp"

namespace sysid {

/// What tasks may name: index of the good ones, nothing for those that failed their own check (then the task is left alone).
struct TaskNames {
  std::map<std::string, std::optional<int>> models, data, candidates, dictionaries;
  DeclaredNames declared;
};

/// The task, or nothing when a diagnostic was added or it refers to something that failed. file: models, data, candidates,
/// dictionaries and the tasks before it; a selection adds its distance to the graphs of its models.
std::optional<Task> check_task(ast::Task const& tree, TaskNames const& names, CheckedFile& file, Backends const& backends,
                               std::span<ast::Task const* const> all_tasks, Diagnostics& diagnostics);

/// The name results go under: given, or VERB_SUBJECT.
std::string task_name(ast::Task const& tree);

}  // namespace sysid
