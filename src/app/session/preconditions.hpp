// What must hold before a task begins: its data can be read and cut, and its back end takes the model. Asked of all tasks of a file
// at once, so that the last one does not fail after the first has sampled for an hour.
#pragma once
#include <functional>
#include <optional>

#include "app/session/session.hpp"
#include "app/session/task_rows.hpp"
#include "core/text/diagnostic.hpp"
#include "experiment/experiments.hpp"

namespace sysid {

/// Why a fit cannot begin: settings that do not go together, a prior that cannot be drawn from, nothing to fit or nothing measured.
std::optional<Diagnostic> refusal(Task const& task, FitTask const& what, Model const& model,
                                  std::vector<ExperimentData> const& data);

/// The same of a selection: settings, then each candidate's priors and data. data: per candidate.
std::optional<Diagnostic> refusal(Task const& task, SelectTask const& what, std::vector<Model> const& models,
                                  std::vector<std::vector<ExperimentData>> const& data);

/// Settings of a discovery that do not go together, and parts of its data that hold no motion.
std::optional<Diagnostic> refusal(Task const& task, DiscoverTask const& what, CheckedFile const& file,
                                  std::vector<ExperimentData> const& data);

struct Preconditions {
  Diagnostics diagnostics;
  bool unreadable = false;  // all of them are files that cannot be read
  /// UnreadableData or UnusableData when there is anything.
  void require() const;
};

/// Reads the data of the wanted tasks and asks `refusal`; each mistake once. Data that a wanted simulate
/// task of the file makes are left for later.
Preconditions check_preconditions(Session& session, std::function<bool(Task const&)> const& wanted);

/// Of all tasks, as far as it can be known before any runs: data that a simulate task makes are looked at where they are there.
Preconditions check_preconditions(Session& session);

/// The simulate task whose result the data block reads, or nullptr.
Task const* maker(Session const& session, DataBlock const& block);

}  // namespace sysid
