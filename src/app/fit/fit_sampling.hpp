// A fit from its data to its draws: prepared, sampled, kept on the way, and done again where the draws ask for it.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/fit/fit_likelihood.hpp"
#include "app/fit/fit_preparation.hpp"
#include "app/search/higher_place.hpp"
#include "app/session/preparation.hpp"
#include "app/session/session.hpp"
#include "app/session/task_checkpoint.hpp"
#include "diagnostics/tolerance/tolerance_check.hpp"
#include "inference/backend/backend.hpp"

namespace sysid {

class FitSampling {
 public:
  /// Loads the data; UserError where they do not suit the model. session, task and what outlive it. checkpoint: of the run, or one
  /// that is kept nowhere.
  FitSampling(Session& session, Task const& task, FitTask const& what, TaskCheckpoint checkpoint, BackendRow const* backend);
  FitSampling(FitSampling const&) = delete;

  /// To the last draw, from what an interrupted run has kept. Nothing where it is interrupted before there is a draw: then
  /// `stopped` says so. UserError where the fit is refused, or comes to no result.
  std::optional<FitResult> run();
  /// The same without anything kept or taken up; nothing where it is interrupted.
  std::optional<FitResult> run_unkept();
  ExitCode stopped() const { return stopped_; }

  std::uint64_t seed() const { return seed_; }
  TaskCheckpoint& checkpoint() { return checkpoint_; }
  std::vector<ExperimentData> const& data() const { return data_; }
  FitLikelihood& likelihood() const { return *likelihood_; }
  Model const& model() const { return model_; }
  Preparation const& preparation() const { return preparation_; }
  /// With the back end that `auto` stands for, once there is a result; why it was chosen, empty where the task names it.
  FitTask const& chosen() const { return chosen_; }
  std::string const& reason() const { return reason_; }
  ObjectiveKind objective_kind() const { return backend_->objective_kind; }
  /// Of the draws, where it has been looked at.
  std::optional<SolverCheck> const& accuracy() const { return accuracy_; }
  /// Of the sampling alone; with the preparation's, of the whole fit.
  Ledger const& ledger() const { return ledger_; }
  Ledger whole_ledger() const;
  /// Of solves for checks, which no report shows.
  Ledger& extra() { return extra_; }

 private:
  /// What is to be done once more after a result: the solver from this one on, and before it the search from `place`, unless empty.
  struct Again {
    SolverSettings solver;
    std::vector<double> place;
  };

  bool prepare(nlohmann::json const* stored);
  bool go_on(nlohmann::json const& stored, RunContext& context);
  std::optional<FitResult> sample_to_end(RunContext& context);
  RunContext searching(Ledger& ledger);
  FitResult sample(RunContext& context);
  void choose_backend();
  void check_draws_of(FitResult const& result);
  bool to_be_chosen_again(FitResult const& result) const;
  std::vector<double> higher_place(FitResult const& result);
  HigherSearch choose_again(Again const& from, nlohmann::json const* steps);
  void require_method(SolverSettings const& stored) const;
  bool go_on_choosing(nlohmann::json const& stored);

  Session& session_;
  Task const& task_;
  FitTask const& what_;
  TaskCheckpoint checkpoint_;
  std::uint64_t seed_;
  FitTask chosen_;
  BackendRow const* backend_;
  std::string reason_;
  std::vector<ExperimentData> data_;
  std::unique_ptr<FitLikelihood> likelihood_;
  Model const& model_;
  FitPreparation preparing_;
  Preparation preparation_;
  Ledger ledger_;
  std::optional<SolverCheck> accuracy_;
  Ledger extra_;
  ExitCode stopped_ = ExitCode::interrupted;
};

}  // namespace sysid
