// What the tasks of one run share: the checked file, compiled models, results of earlier tasks, where files go.
#pragma once
#include <filesystem>
#include <map>
#include <memory>
#include <ostream>
#include <string>
#include <tuple>

#include "app/session/options.hpp"
#include "check/checked/checked.hpp"
#include "core/system/progress.hpp"
#include "core/text/source.hpp"
#include "data/record.hpp"
#include "experiment/experiments.hpp"
#include "likelihood/compiled_model.hpp"
#include "result/draws.hpp"

namespace sysid {

/// What a fit leaves for the tasks that refer to it.
struct FittedModel {
  Draws draws;
  SolverSettings solver;
};

/// What a selection leaves: per candidate its probability and particles of equal weight (parameters that the simulation reads).
struct SelectedCandidate {
  double probability = 0;
  Draws draws;
  SolverSettings solver;  // of their simulations
};

class Session {
 public:
  Session(Source const& source, CheckedFile const& file, RunOptions const& options, Progress& progress, std::ostream& out,
          std::ostream& notices)
      : source(source), file(file), options(options), progress(progress), out(out), notices(notices) {}

  Source const& source;
  CheckedFile const& file;
  RunOptions const& options;
  Progress& progress;
  std::ostream& out;                                       // summaries
  std::ostream& notices;                                   // one line each: what was chosen, what was written
  std::map<int, FittedModel> fitted;                       // by index of the fit task
  std::map<int, std::vector<SelectedCandidate>> selected;  // by index of the select task

  /// The folder of the .sysid file, from which data paths are relative.
  std::filesystem::path folder() const { return std::filesystem::path(source.name()).parent_path(); }
  /// Where the results of a task are: in a folder of its name, unless they were found elsewhere.
  std::filesystem::path result_folder(Task const& task) const;
  /// The results of a task were found in `folder`, whatever its name. What was read of others before is forgotten.
  void find_results_in(std::filesystem::path folder, Task const& task);
  /// The model of a fit, compiled on first use for its filter and with the errors of its inputs. A prediction has a start, a solver
  /// and a rule of its own.
  std::shared_ptr<CompiledModel const> compiled(FitTask const& fit, bool free_start, std::string const& method,
                                                PredictionRule prediction);
  /// As a fit to data of its own has it.
  std::shared_ptr<CompiledModel const> compiled(FitTask const& fit, std::string const& method);
  /// The record of a data block as a model of the file reads it, read on first use. Throws as `load_record`.
  Record const& record(int data, Model const& model);
  /// From here on `record` is that for this model.
  void replace_record(int data, Model const& model, Record record);
  /// The seed of a task: the command line's, the file's, or one drawn from the system and printed.
  std::uint64_t seed(Task const& task, std::optional<std::uint64_t> const& stated);
  /// A sub-expression in the user's words, for the ledger.
  std::string describe(int model, Graph const& graph, NodeId node) const;
  /// Threads in use, 0 resolved.
  int threads() const;
  /// Whether an interruption was asked for; counts polls for `interrupt_after`.
  bool interrupted();
  /// As the options say, but given up when an interruption is asked for: for work of which nothing is kept then.
  ExecutionOptions interruptible() const;
  /// As `interruptible`, but what is given up throws Interrupted: for those that keep what was before it.
  ExecutionOptions abandonable() const;

 private:
  using CompiledKey = std::tuple<int, bool, std::string, PredictionRule, FilterRule, std::vector<double>>;
  std::map<CompiledKey, std::shared_ptr<CompiledModel const>> compiled_;
  std::map<std::pair<int, Model const*>, Record> records_;
  std::map<std::string, std::filesystem::path> found_in_;  // by name of the task
  std::optional<std::uint64_t> drawn_seed_;
  std::uint64_t polls_ = 0;
};

/// The rule by which the model of a fit has its lags where a prediction asks for this one: that of the fit, where one step ahead
/// means that a filter corrects the states. Samples that lags do not read then do not have to be there.
PredictionRule rule_of_lags(FitTask const& fit, Model const& model, PredictionRule asked);

/// Reads them in order, for a model of the file; UserError, UnusableData, UnreadableData as above. solver: which may need equal
/// steps.
std::vector<ExperimentData> load_experiments(Session& session, std::vector<ExperimentUse> const& uses, Model const& model,
                                             StartRule start, PredictionRule prediction, SolverSettings const& solver = {});

}  // namespace sysid
