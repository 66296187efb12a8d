// One task on its way from the tree to what it runs from: what the verbs share, and one function for each verb, in a file of its
// own (task_fit.cpp, task_predict.cpp, task_simulate.cpp, task_discover.cpp, task_select.cpp).
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "check/expression/option_reader.hpp"
#include "check/message/subject.hpp"
#include "check/task/tasks.hpp"

namespace sysid {

class TaskChecker {
 public:
  TaskChecker(ast::Task const& tree, TaskNames const& names, CheckedFile& file, Backends const& backends,
              std::span<ast::Task const* const> all_tasks, Diagnostics& diagnostics);

  /// The checked task, or nothing when an error was reported or the task refers to something that failed its own check.
  std::optional<Task> run();

 private:
  // --- tasks.cpp
  // The subject is no such item: it may be one of another kind.
  void explain_subject(Diagnostic& unknown) const;
  std::optional<int> item(ast::Name const& name, std::map<std::string, std::optional<int>> const& items, std::string const& kind);
  // Equations that cannot be solved for their highest derivatives need a solver that does without.
  void suit(SolverSettings& solver, Model const& model);
  // A solver that was stated, where no model of the task has differential equations.
  void report_needless_solver();
  // An exact step needs linear equations.
  void suit_exact(SolverSettings const& solver, Model const& model);
  void suit(StartRule const& start, Model const& model, std::vector<ast::Option> const& options);
  void suit(FitTask& task, Model const& model);
  // `prediction = one_step`, for models that have lags to read. corrected: fits whose random states samples correct in a
  // prediction, which the rule is of, too.
  void steps_ahead(ast::Option const& option, std::span<int const> models, std::span<int const> corrected, PredictTask& task);
  void prediction(ast::Option const& option, std::span<int const> models, PredictionRule& rule,
                  std::span<int const> corrected = {});
  // Whether the option says how a fit simulates; read into `task` then.
  bool simulation_option(ast::Option const& option, std::string const& key, std::span<int const> models, FitTask& task);
  // Each argument of `values(m = 1, ...)`, `noise(displacement = 0.1 [mm])` with the index of its name among `known`, once.
  // owner, member: "model `duffing`", "parameter".
  void each_named(ast::Call const& call, errors::Subject const& owner, std::string const& member,
                  std::vector<std::string> const& known, std::function<void(ast::Argument const&, std::size_t)> const& visit);
  // Whether the option names a back end, known or not.
  bool backend_option(ast::Option const& option, std::string const& key, std::span<BackendSettings const> known,
                      std::string& backend, Settings& settings);

  // --- task_filter.cpp
  // `filter = unscented`.
  void filter(ast::Option const& option, FilterRule& rule);
  // Of each input of the model, from the data blocks of the experiments; empty where none has one.
  std::vector<double> input_errors(std::vector<ExperimentUse> const& experiments, Model const& model);
  // What no filter takes is refused, where the states of the model are random as it is fitted.
  void suit_filter(FitTask& task, Model const& model);
  // The model as it is fitted, errors of inputs included; nothing when they were refused. Without random states it is not filtered.
  std::optional<Model> as_fitted(FitTask const& task, Model const& model);
  // The errors of the inputs of the experiments that a fit predicts.
  std::vector<double> predicted_input_errors(FitTask const& fit, std::vector<ExperimentUse> const& experiments);
  // Of a back end that compares simulations: no start that rows determine where each simulation draws its states.
  void suit_distances(SelectTask const& task);
  // Errors of inputs, of which a regression of terms knows nothing.
  void refuse_input_errors(std::vector<ExperimentUse> const& experiments);
  void suit_kalman(FitTask const& task, Model const& model);
  // Noise that filters of moments take. help: what else a fit of other noise may do.
  void suit_noise(Model const& fitted, std::string const& help);
  // Chooses the filter of particles where no other takes the noise, and refuses it where an estimate of the likelihood will not do.
  void suit_particles(FitTask& task, Model const& fitted);
  void refuse_particles(FitTask const& task, Model const& fitted);
  // Where the option of that name was stated, else the verb.
  Span place_of_option(std::string const& name) const;
  // Of a prediction with a fit by particles.
  void suit_forecast(std::vector<FitTask const*> const& fits, PredictTask const& task);
  // The option, where it was stated and no model has had a use for it, and a number of particles of another filter.
  void report_needless_filter(FilterRule filter);

  // --- task_experiments.cpp
  // One experiment of the task, without its name; nothing when a diagnostic was added.
  std::optional<ExperimentUse> experiment(ast::DataReference const& reference, Model const* model);
  // All of the task, named. preposition: before its data, `to`, `on` or `from`; no sample is fitted twice.
  std::vector<ExperimentUse> experiments(Model const* model, std::string const& preposition);

  // --- task_fit.cpp
  FitTask fit();
  // `search = near(posterior)`, or `search = everywhere`.
  void search(ast::Option const& option, std::optional<int>& near);
  // `particles = 1000`, or `particles = automatic`.
  void particles(ast::Option const& option, int& count);
  // `evidence = bridge`.
  void evidence(ast::Option const& option, EvidenceMethod& method);
  // One step ahead, and no differential equations beside it.
  void suit_processes(FitTask const& task, Model const& model);
  void suit_scales(Model const& model);

  // --- task_select.cpp
  SelectTask select();
  // What the task selects among: index into the sets of the file.
  std::optional<int> candidate_set();
  std::vector<FitTask> candidate_fits(CandidateSet const& set, FitTask const& common);
  // The channels that the data measure; all candidates observe them in units of one kind.
  std::vector<std::string> common_channels(CandidateSet const& set, std::vector<ExperimentUse> const& experiments);

  // --- task_discover.cpp
  DiscoverTask discover();
  // `spike_slab(derivatives = weak(...), ...)`.
  void take_settings_of_samples(ast::Call& selector, DiscoverTask& task);
  void discover_method(ast::Option const& option, std::string const& key, CheckedDictionary const* dictionary, DiscoverTask& task);
  void derivatives(ast::Expression const& tree, DiscoverTask& task);
  // `noise(displacement = 0.1 [mm])`.
  void noise(ast::Call const& call, CheckedDictionary const& dictionary, DiscoverTask& task);
  void noise_of_all(ast::Option const& option, CheckedDictionary const* dictionary);
  // Every channel of the dictionary is measured in every experiment.
  void require_channels(CheckedDictionary const& dictionary, DiscoverTask const& task);

  // --- task_predict.cpp
  PredictTask predict();
  // corrected: the models of the fits whose states are random.
  void predict_option(ast::Option const& option, std::string const& key, std::span<int const> models,
                      std::span<int const> corrected, PredictTask& task);
  void draws(ast::Option const& option, int& count);
  // The fits whose draws are used: of a selection one per candidate; none when an error was added.
  std::vector<FitTask const*> predicted_fits(PredictTask& task);
  // The predictions of the members of an average. uses: the experiments, per fit.
  void average(std::vector<FitTask const*> const& fits, std::vector<std::vector<ExperimentUse>> const& uses, PredictTask& task);
  // Whether all fits of the average can have weights, and observe what the data measure.
  void suit_average(std::vector<FitTask const*> const& fits, PredictTask const& task);
  void suit_channels(std::vector<FitTask const*> const& fits, DataBlock const& block);
  // Index of the task above whose draws are used; nothing when it is none.
  std::optional<int> fitted_task(ast::Name const& name, bool or_selection);

  // --- task_simulate.cpp
  SimulateTask simulate();
  struct SimulateOptions;    // what the options say, on the way to the task
  struct SimulateOptionRow;  // an option's name with one of the functions below
  void simulate_option(ast::Option const& option, SimulateOptions& options);
  void simulate_input(ast::Option const& option, SimulateOptions& options);
  static void simulate_noise(TaskChecker& checker, ast::Option const& option, SimulateOptions& options);
  static void simulate_samples(TaskChecker& checker, ast::Option const& option, SimulateOptions& options);
  static void simulate_spacing(TaskChecker& checker, ast::Option const& option, SimulateOptions& options);
  static void simulate_solver(TaskChecker& checker, ast::Option const& option, SimulateOptions& options);
  static void simulate_seed(TaskChecker& checker, ast::Option const& option, SimulateOptions& options);
  static void simulate_file(TaskChecker& checker, ast::Option const& option, SimulateOptions& options);
  // What is left out is taken from the model or missed; what must hold between the options.
  void complete_simulation(SimulateOptions const& options);
  void check_exact_inputs(SimulateOptions const& options);
  // `values(m = 1, ...)`.
  void values(ast::Call const& call, Model const& model, SimulateTask& task);
  // The names that states, channel locations and (when the model makes the noise) noise need.
  std::vector<std::string> values_needed(Model const& model, SimulateTask const& task) const;

  ast::Task const& tree_;
  TaskNames const& names_;
  CheckedFile& file_;
  Backends backends_;
  std::span<ast::Task const* const> all_tasks_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  OptionReader options_;
  std::optional<Span> filter_;  // where it was stated
  std::optional<Span> particles_;
  bool filter_needed_ = false;  // by a model of the task
  bool solver_needed_ = false;  // the same
  bool unresolved_ = false;     // the task refers to something that failed its own check
};

std::vector<std::string> names_of(std::span<BackendSettings const> backends);

}  // namespace sysid
