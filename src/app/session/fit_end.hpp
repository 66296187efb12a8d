// The end of every fit, for all likelihoods: no result, an interrupted one, or a report on disk and draws for later tasks.
#pragma once
#include <chrono>
#include <vector>

#include "app/session/preparation.hpp"
#include "app/session/session.hpp"
#include "app/session/task_checkpoint.hpp"
#include "core/text/diagnostic.hpp"
#include "likelihood/parameter_space.hpp"
#include "result/finding.hpp"
#include "result/report.hpp"

namespace sysid {

/// A back end or search that has no result, as an error at the task.
Diagnostic no_result(Task const& task, Finding const& failure);

/// Interrupted before there was a draw to keep.
ExitCode stop_early(Session& session, Task const& task, TaskCheckpoint const& checkpoint);

/// Interrupted while the result was looked at, which is done again from the back end's last checkpoint, or where it has made none
/// from the search's end.
ExitCode stop_late(Session& session, Task const& task, TaskCheckpoint& checkpoint, Preparation const& preparation);

/// Solves that failed while sampling, where they are too many to say nothing of.
Findings failure_findings(Ledger const& sampling);

/// Of one column of draws; one draw has no spread.
Summary of_column(Draws const& draws, std::size_t column);

/// The draw of highest density, all its columns; empty where there is none.
std::vector<double> best_draw(Draws const& draws);

/// Sampled parameters that only the noise of the channels reads, as the fit names them.
std::vector<std::string> noise_parameters(ParameterSpace const& space);

/// Judges, writes and shows the report; the task is over unless it was interrupted: then its checkpoint goes, and its draws stay
/// for tasks that refer to it.
ExitCode conclude_fit(Session& session, int index, Task const& task, TaskCheckpoint const& checkpoint, SolverSettings const& solver,
                      Report report, std::chrono::steady_clock::time_point began, bool interrupted);

}  // namespace sysid
