// Data blocks to experiments: a record is read once per model and block, parts are cut from it for each task.
#pragma once
#include <filesystem>
#include <memory>

#include "check/checked/checked.hpp"
#include "core/text/diagnostic.hpp"
#include "data/record.hpp"
#include "likelihood/parameter_space.hpp"
#include "result/report.hpp"

namespace sysid {

/// Data files that cannot be read, with the places in the text that name them: exit code 74.
class UnreadableData : public IoError {
 public:
  explicit UnreadableData(Diagnostics diagnostics)
      : IoError(diagnostics.all().front().message), diagnostics_(std::move(diagnostics)) {}
  Diagnostics const& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics diagnostics_;
};

/// Data that cannot be used, with all that is wrong with them.
class UnusableData : public UserError {
 public:
  explicit UnusableData(Diagnostics diagnostics) : UserError(diagnostics.all().front()), diagnostics_(std::move(diagnostics)) {}
  Diagnostics const& diagnostics() const { return diagnostics_; }

 private:
  Diagnostics diagnostics_;
};

/// The record of a data block as a model reads it; `folder`: that of the .sysid file, from which paths are relative.
/// UnusableData when something is wrong with it, UnreadableData when the file cannot be read.
Record load_record(DataBlock const& block, Model const& model, std::filesystem::path const& folder);

/// The rows of a part (-1: all), started as the task says; the first rows that a discrete-time model looks back to are left out.
/// Throws UserError when they are outside the record, the start needs more rows, or the model needs a sample that is missing.
Experiment cut(Record const& record, DataBlock const& block, Model const& model, int part, StartRule start);

/// Whether the equations are such that a solver's step may be exact for them.
bool is_linear_in_states(Model const& model);
/// Whether such a solver could take the rows.
bool allows_exact_steps(Experiment const& experiment, Model const& model);
/// UserError where a solver's step is exact, but not along these rows: an input between them is no straight line, or no constant
/// where the equations read it other than linearly.
void require_exact_steps(Experiment const& experiment, DataBlock const& block, Model const& model, SolverSettings const& solver);

/// What a task has of one of its experiments.
struct ExperimentData {
  ExperimentUse use;
  Record record;
  Experiment experiment;  // cut and started as the task says; its name is that of the data, "bench.train"
};
std::vector<Experiment> experiments_of(std::vector<ExperimentData> const& data);
/// Whether a solver whose step is exact could take all of them.
bool allow_exact_steps(std::vector<ExperimentData> const& data, Model const& model);

/// The parameters of a model over the experiments of a fit.
std::shared_ptr<ParameterSpace const> parameter_space(Model const& model, std::vector<ExperimentUse> const& uses);

/// "bench.train, hall".
std::string data_names(CheckedFile const& file, std::vector<ExperimentUse> const& uses);

/// The priors of a model's parameters, by name, as those of the sampled parameters of a fit: one for each experiment that has its
/// own.
std::vector<PriorInfo> priors_of(ParameterSpace const& space, std::vector<PriorInfo> const& of_model);

/// Whether the model, under its rule, reads measured past samples.
bool predicts_from_data(Model const& model);

/// Which rule is in force and what it comes to: "as_written: from measured samples".
std::string prediction_text(Model const& model, PredictionRule rule);
/// Of a prediction, random states included; empty for a model that has one way to predict only.
/// ahead: as PredictTask has it.
std::string predicted_text(Model const& model, PredictionRule rule, int ahead = 0);

/// "bench.train".
std::string data_name(DataBlock const& block, int part);

}  // namespace sysid
