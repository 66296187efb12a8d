// What reports of all tasks share: model text, equations, priors, versions.
#pragma once
#include <chrono>
#include <optional>

#include "app/session/session.hpp"
#include "core/text/diagnostic.hpp"
#include "result/report.hpp"

namespace sysid {

/// A report with everything known before the task has run.
Report begin_report(Session const& session, Task const& task, int model, std::string what, std::uint64_t seed);

/// The rule of a discrete-time model, whether it predicts from measured past samples, and how many samples it looks back. model:
/// as it is compiled under the rule.
void add_prediction_rule(Model const& model, PredictionRule rule, Report& report);
/// Likewise of a prediction, where random states are corrected by samples or run freely in continuous time, too.
void add_predicted_rule(Model const& model, PredictionRule rule, Report& report);

/// The verb that makes a result again, and its options besides those of a run.
struct Repetition {
  std::string verb = "run", options = {};
};

/// The task's place in its file and the command that makes its result again, from the folder in which the run was started. Of seeds
/// that were drawn the command carries one where all tasks that it takes have it; else they are named, to be written into the file.
void add_repetition(Session const& session, Task const& task, Report& report, Repetition const& repetition = {});

/// The priors of a model as they stand in its text, in the order of its declarations.
std::vector<PriorInfo> declared_priors(Session const& session, int model);

/// Writes the folder of a task's results and prints their summary; a notice names pictures that could not be drawn. The formulas
/// and fixed values of the report are set from its texts first: the writers of results parse nothing. written: as `write_result`
/// takes it.
void keep_result(Session& session, Task const& task, Report& report, std::vector<std::string> const& written = {});

/// SHA-256 of a model's text.
std::string model_digest(Session const& session, std::string const& model);

/// Of what a task is about, a model, all candidates or a dictionary: what stored results are compared by.
std::string task_digest(Session const& session, Task const& task);

/// Of a task's statement and what the blocks of its data say, other parts of them left out: draws of other rows, or of fewer, are
/// another task's.
std::string statement_digest(Session const& session, Task const& task);

/// What is wrong with taking up stored results of a task: they are of another text of what the task is about, of another statement
/// or other experiments, of other contents of their files, of another seed (when one is stated), or of another verb than `verb`
/// (empty: the task's own); nothing when they fit.
std::optional<Diagnostic> stored_otherwise(Session const& session, Task const& task, std::optional<std::uint64_t> seed,
                                           std::string const& verb = {});

/// How long it took, and on what.
void add_timing(Session const& session, std::chrono::steady_clock::time_point began, Report& report);

/// Says that a task is complete, with the verdict of its stored result, which stays as it is; the exit code of the run that made
/// it: a script that is started again must not take a failed check for success.
ExitCode keep_complete(Session& session, Task const& task);

}  // namespace sysid
