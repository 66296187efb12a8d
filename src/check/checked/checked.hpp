// A checked file: what every later stage works from. Models are typed and first order; data blocks and tasks refer to them by
// index.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "check/checked/inner_parameter.hpp"
#include "core/setting/average_weights.hpp"
#include "core/setting/evidence_method.hpp"
#include "core/setting/settings.hpp"
#include "data/experiment.hpp"
#include "data/start_rule.hpp"
#include "data/table/reading_rules.hpp"
#include "model/filter_rule.hpp"
#include "model/lags.hpp"
#include "regression/column/dictionary.hpp"
#include "solver/solver.hpp"
#include "syntax/ast.hpp"

namespace sysid {

/// A column of a data block: its name in the file and the unit its numbers have.
struct ColumnUse {
  std::string column;
  std::optional<Unit> unit;
  Span span;
};

/// `error normal(sd = 0.5)`: how far samples of an input lie from the truth.
struct InputErrorUse {
  double sd = 0;             // SI; of a bare number beside a column without a unit as written: then in the unit of the input
  bool bare = false;         // it is that
  std::optional<Unit> unit;  // of a number with one
  Span span;
};

struct DataInputUse : ColumnUse {
  std::string input;
  std::optional<InputRule> rule;  // absent: not stated, which only models in continuous time refuse
  Span input_span;
  Span rule_span;  // of the whole statement where there is none
  std::optional<InputErrorUse> error{};
};

struct DataMeasureUse : ColumnUse {
  std::string channel;
  Span channel_span;
};

/// Rows first..last of the file, counted from 1, both included.
struct DataPart {
  std::string name;
  int first = 1;
  int last = 0;  // 0: the last row of the file
  Span span;
};

/// `constant dose = 30 [mg]`: what a parameter is in this experiment.
struct DataConstantUse {
  std::string parameter;
  double value = 0;          // SI above the zero of its unit; of a bare number as written: then in the unit of the parameter
  std::optional<Unit> unit;  // absent: a bare number
  Span span, value_span;
};

struct DataBlock {
  std::string name;
  Span span;
  std::string path;  // as written, relative to the .sysid file
  Span path_span;
  std::string shown_path;  // what messages and results name in its place; empty: `path`
  ReadingRules rules{};    // how the file is written
  std::optional<ColumnUse> time;
  double step = 0;                   // [s], when there is no time column; 0: the block does not say when its rows were taken
  bool step_stated = false;          // by `step`, else by `rate`
  std::optional<Span> step_place{};  // of what states it
  std::vector<DataInputUse> inputs;
  std::vector<DataMeasureUse> measured;
  std::vector<DataConstantUse> constants;
  std::vector<DataPart> parts;

  std::string const& mention() const { return shown_path.empty() ? path : shown_path; }
};

/// A data reference of a task: one experiment of its model.
struct ExperimentUse {
  int data = 0;
  int part = -1;     // -1: all rows
  std::string name;  // its index in tables: the block's name, with the part where the block is used twice
  std::vector<std::optional<double>> constants;  // per model parameter, SI: what the data block fixes
};

/// A generated input record.
struct InputGenerator {
  enum class Kind { gaussian, sine, multisine, constant };
  Kind kind = Kind::gaussian;
  std::map<std::string, double> arguments;  // coherent SI
  InputRule rule = InputRule::zero_order;
};

struct SimulateTask {
  int model = 0;
  std::vector<std::optional<double>> values;  // per model parameter, SI; absent: not given
  std::vector<InputGenerator> inputs;         // per model input
  double noise_fraction = -1;                 // of the standard deviation of each clean channel; negative: the model's own noise
  int samples = 0;
  double step = 0;  // [s]
  SolverSettings solver;
  std::optional<std::uint64_t> seed;
  std::string file;  // name of the CSV in the result folder
};

struct FitTask {
  int model = 0;
  std::vector<ExperimentUse> experiments;
  std::string backend;
  Settings settings;  // of the back end
  StartRule start;
  PredictionRule prediction = PredictionRule::as_written;
  SolverSettings solver;
  bool solver_stated = false;  // its method, or how fine it is
  bool refine_solver = true;   // the tolerance guard chooses how fine the solver is, from `solver` on
  std::optional<int> near;     // index of the fit at whose draws the search for modes begins; absent: it begins everywhere
  EvidenceMethod evidence = EvidenceMethod::automatic;
  std::optional<std::uint64_t> seed;
  FilterRule filter = FilterRule::automatic;  // of random states
  std::string particles_because;              // of a filter that was not stated: why it is that of particles
  int particles = 0;                          // 0: as many as the likelihood at the mode needs
  std::vector<double> input_errors;           // per model input the sd of its error, SI; empty: none has one
};

/// One model of a set, expanded: "bouc_wen(n = 2)".
struct CandidateModel {
  int model = 0;  // index into CheckedFile::models
  double probability = 0;
  Span span;
  std::string name;
};

/// Models that explain the same data; their probabilities sum to 1. A task that names a model where a set may stand has a set of
/// that model alone, under its name.
struct CandidateSet {
  std::string name, title;
  Span span;
  std::vector<CandidateModel> models;
  std::vector<std::string> shared;  // parameters that mean the same in every model that has them
};

/// How far a simulation without noise lies from the data: of each channel one number, their mean by weights.
struct DistanceRule {
  enum class Kind {
    nmse,        // 100 x mean square of the residuals / variance of what was measured
    rmse,        // root of their mean square
    expression,  // the mean of an expression of the sample and its simulation, not negative
  };
  Kind kind = Kind::nmse;
  std::vector<std::string> channels;             // that the data measure, in the order of the first candidate's declarations
  std::vector<double> weights;                   // per channel, not negative, not all 0
  double unit = 1;                               // rmse: its unit in SI, that of the first candidate's first channel with a weight
  std::vector<std::vector<NodeId>> expressions;  // [candidate][channel] in the graph of the candidate's model, SI; else empty
  std::string text;                              // as written
  std::vector<std::string> weighted;             // channels whose weight is stated
  bool stated = false;                           // it or weights
};

/// The selection of a model among candidates.
struct SelectTask {
  int candidates = 0;         // index into CheckedFile::candidates
  std::vector<FitTask> fits;  // per candidate: what it is fitted to and how it is simulated, without a back end
  std::string backend;
  Settings settings;
  DistanceRule distance;
  std::optional<std::uint64_t> seed;
};

/// With the draws of a fit, of a selection, whose candidates count as much as they are probable, or of several fits that are
/// weighed.
struct PredictTask {
  int fit = 0;  // index into CheckedFile::tasks; of an average the first
  std::vector<ExperimentUse> experiments;
  std::vector<int> fitted;  // per experiment the one of the fit whose parameters it has; -1: a new one
  std::vector<std::vector<ExperimentUse>>
      candidate_experiments;  // of a selection, per candidate; `experiments` are the first one's
  int draws = 200;
  bool redraw_each_step = false;  // the tutorial's Fig. 8.4; the default is one draw per trajectory
  StartRule start;
  PredictionRule prediction = PredictionRule::as_written;
  int ahead = 0;  // rows between what is predicted and the last that correct its random states; 0: as `prediction` says
  std::vector<double> input_errors;                         // those of the experiments, as FitTask::input_errors
  std::vector<std::vector<double>> candidate_input_errors;  // of a selection or an average, per model
  std::optional<std::uint64_t> seed;
  std::vector<PredictTask> members;  // of an average, of each fit the prediction with it alone; else none
  AverageWeights weights = AverageWeights::evidence;

  bool averages() const { return !members.empty(); }
};

/// A term of one equation of a dictionary, as the numbers beside it know it by its index.
struct DictionaryTerm {
  std::string text;          // "abs(y')*y'"; of a free coefficient of the target what it stands before there
  ast::Expression tree;      // the same; of a free coefficient of the target: the parameter
  std::string coefficient;   // the parameter before it; empty: none was named
  bool in_target = false;    // it stands there, with its coefficient
  std::optional<Unit> unit;  // of the coefficient; absent: unchecked
  Span span;
};

struct DictionaryEquation {
  std::string text;      // "m*y'' - x"
  ast::Expression tree;  // the target as written
  std::optional<Unit> unit;
  std::vector<DictionaryTerm> terms;  // parallel to regression::Equation::terms
};

/// A term that the dictionary could hold and does not.
struct ExcludedTerm {
  enum class Why { same, zero, excluded, unit };
  Why why = Why::same;
  std::string text;
  std::string detail;  // same: the term it is the same as; unit: the unit that its coefficient would have
  int equation = -1;   // -1: every one
};

struct CheckedDictionary {
  std::string name, title;
  Span span;
  ast::Dictionary tree;
  std::vector<ast::FunctionDefinition> functions;  // of the file, that its expressions may call
  regression::Dictionary numbers;                  // with parameters inside terms at the medians of their priors
  std::vector<DictionaryEquation> equations;
  std::vector<InnerParameter> inner;
  OpenTerms open;  // empty where there are none
  std::vector<ExcludedTerm> excluded;
  std::vector<Quantity> states;
  std::vector<Span> channel_spans;  // where each channel is bound
  /// What data blocks are bound to: inputs and channels, no states and no noise.
  Model measured;
};

/// Equations from records.
struct DiscoverTask {
  int dictionary = 0;  // index into CheckedFile::dictionaries
  std::vector<ExperimentUse> experiments;
  std::string form;  // of derivatives
  Settings form_settings;
  std::string selector;
  Settings selector_settings;
  std::vector<std::optional<double>> noise;  // sd per channel of the dictionary, SI; absent: estimated from the record
  int top = 5;                               // supports that are shown, and written as candidates
  bool candidates = false;                   // whether they are
  bool refit = true;                         // by simulation: ranked by the evidence of the motion, scored on rows kept aside
  std::optional<std::uint64_t> seed;
};

struct Task {
  std::string name;
  Span span;
  std::variant<SimulateTask, FitTask, SelectTask, DiscoverTask, PredictTask> what;
};

struct CheckedFile {
  ast::File tree;  // flat, for texts of models in reports
  std::vector<Model> models;
  std::vector<DataBlock> data;
  std::vector<CandidateSet> candidates;
  std::vector<CheckedDictionary> dictionaries;
  std::vector<Task> tasks;
};

}  // namespace sysid
