// What a task reads and what it is about: one row for each kind of task.
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "check/checked/task_kinds.hpp"
#include "core/text/diagnostic.hpp"
#include "experiment/experiments.hpp"

namespace sysid {

/// The data of a task, once for each model that reads them, those of a discovery for what its dictionary is bound to; empty for a
/// simulate task.
struct TaskData {
  Model const* model = nullptr;
  std::vector<ExperimentUse> const* experiments = nullptr;
  StartRule start;
  PredictionRule prediction = PredictionRule::as_written;
  SolverSettings solver;
};

/// Of a predict task, `name` and `digest` are those of the task that it predicts with.
struct TaskRow {
  TaskKind kind;
  /// The experiments that it names; of a selection those of the first candidate.
  std::vector<ExperimentUse> (*experiments)(Task const&);
  std::vector<TaskData> (*data)(CheckedFile const&, Task const&);
  /// What it is about: "model `duffing`"; of a selection the first model.
  std::string (*name)(Session const&, Task const&);
  /// Of the text of what it is about.
  std::string (*digest)(Session const&, Task const&);
  /// Why it cannot begin, its data being there.
  std::optional<Diagnostic> (*refusal)(Session&, Task const&);
  /// Tasks above whose results it needs.
  std::vector<int> (*needs)(Task const&);
};

/// The tasks that a prediction is made from: "linear_fit, cubic_fit".
std::string predicted_names(CheckedFile const& file, PredictTask const& what);

std::span<TaskRow const> task_rows();
/// The row for a task's kind.
TaskRow const& task_row(Task const& task);

}  // namespace sysid
