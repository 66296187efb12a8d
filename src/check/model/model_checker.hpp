// One model on its way from the tree to what every later stage works from: the passes and what they share. Each pass is defined in
// a file of its own, model_*.cpp; `run` in model.cpp puts them in order.
#pragma once
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "check/expression/leaves.hpp"
#include "check/expression/scope.hpp"
#include "check/expression/value_range.hpp"
#include "check/message/errors.hpp"
#include "core/text/diagnostic.hpp"
#include "model/disturbance_law.hpp"
#include "model/model.hpp"
#include "syntax/ast.hpp"

namespace sysid {

class ModelChecker {
 public:
  ModelChecker(ast::Model const& tree, std::vector<ast::FunctionDefinition const*> const& shared, Diagnostics& diagnostics);

  /// The checked model, or nothing when an error was reported.
  std::optional<Model> run();

  UnitCheck const& units() const { return scope_.units(); }

 private:
  struct StateInfo {
    ast::Declared const* declaration = nullptr;
    int order = 0;
    int first = 0;
  };

  bool failed() const { return diagnostics_.has_errors(before_); }

  template <class Statement, class Visit>
  void each(Visit const& visit) {
    for (ast::ModelStatement const& statement : tree_.statements)
      if (auto const* one = std::get_if<Statement>(&statement)) visit(*one);
  }

  // --- model_declarations.cpp
  void declare();
  // How many statements read each name, and whether it is of noise alone: help on units offers names by it.
  void note_places();
  void declare_in(ast::TimeDeclaration const& time);
  void declare_in(ast::DiscreteTimeDeclaration const& discrete);
  void declare_in(ast::InputDeclaration const& inputs);
  void declare_in(ast::StateDeclaration const& states);
  void declare_in(ast::DisturbanceDeclaration const& disturbance);
  void declare_in(ast::ParameterDeclaration const& parameter);
  void declare_in(ast::Definition const& definition);
  void declare_in(ast::FunctionDefinition const& function);
  void declare_in(ast::ProcessDefinition const& process);
  template <class Other>
  void declare_in(Other const&) {}  // declares no name
  // Of an unknown function that is a finite sum.
  void declare_coefficients(Scope::ProcessName& process);
  StateInfo* find_state(std::string const& name);
  std::size_t index_of(StateInfo const& info) const;
  std::vector<std::string> state_names() const;
  /// Components of states that no declaration gives an initial value.
  std::vector<std::string> without_initial() const;
  // The order of a state is the most primes it carries in an equation or in what an equation uses.
  void find_orders();
  void lay_out_states();

  // --- model_equations.cpp
  void equations();
  // In discrete time: a state on both sides of its equation, whose past nothing reads.
  void report_forgotten_lags(std::vector<ast::Equation const*> const& trees, std::vector<NodeId> const& residuals,
                             std::vector<NodeId> const& right);
  std::string unknown_name(std::size_t state) const;
  // A state that is never differentiated is an algebraic unknown, where others are.
  bool may_be_algebraic(std::string const& name, StateInfo const& info);
  // As many equations as states, differentiated where they are constraints; said by name where that cannot be.
  bool reduce_to_index_one(std::vector<ast::Equation const*> const& trees, std::vector<NodeId>& residuals);
  bool mentioned(std::string const& state);
  // The most primes of a state in `initial`; -1 without any.
  int initial_primes(std::string const& state);
  // Names the derivative to write an equation for: the initial values tell the order that the user has in mind.
  Diagnostic without_equation(std::string const& name, StateInfo const& info);
  // Where an equation could not be understood, only a state that stands in none is surely left without one.
  void report_unmentioned_states();
  // As many equations as states, each state with one that contains its highest derivative: said by name where it is not so.
  bool enough_equations(std::vector<ast::Equation const*> const& trees, std::vector<NodeId> const& residuals);
  // In channels and derived quantities a highest derivative (an acceleration) stands for its solution.
  NodeId solved(NodeId node);

  // --- model_disturbances.cpp
  // Of those that declare none, from their laws.
  void infer_disturbance_units();
  // Those with a memory, and all in discrete time, are states behind the declared ones.
  void lay_out_disturbances();
  void disturbances();
  std::optional<std::vector<NodeId>> law_arguments(ast::DisturbanceDeclaration const& tree, Disturbance const& disturbance,
                                                   DisturbanceLawRow const& row);
  std::optional<NodeId> law_argument(ast::DisturbanceDeclaration const& tree, Disturbance const& disturbance,
                                     DisturbanceArgumentRow const& row, ast::Expression const& value_tree);
  std::optional<NodeId> sd_of_samples(ast::DisturbanceDeclaration const& tree, Disturbance const& disturbance);
  void positive_laws(ValueRanges& ranges);
  // Linear in the derivatives, white noise in no channel, and nothing beside them that no filter takes.
  void place_disturbances();
  bool reads_white_noise(NodeId root, int& which) const;

  // --- model_initial.cpp
  // Of `initial y ~ normal(...)`, a mean and a variance; nothing when a diagnostic was added.
  struct RandomStart {
    NodeId mean, variance;
  };
  std::optional<RandomStart> random_start(ast::Call const& law, Quantity const& state);
  // In discrete time one value stands for all samples before the first; it may be what a channel measured there.
  void initial_lags();
  void initial_values();
  /// Of components without an initial value: a parameter of their unit that nothing reads, where one is meant, or 0.
  std::vector<errors::StartValue> values_to_give(std::vector<std::size_t> const& components) const;
  /// A new parameter, since a temperature begins at 0 in its unit almost never; read: names that are taken; 0 for other quantities.
  errors::StartValue start_of_temperature(State const& state, std::set<std::string> const& read) const;
  // Where the search for an unknown's first value begins.
  void guess(ast::InitialValue const& initial, Unknown& unknown);
  // Initial values of unknowns that the equations give otherwise.
  void unused_starts(std::vector<NodeId> const& initial);
  // Equations that were differentiated must hold at the start.
  void constraints();

  // --- model_processes.cpp
  // Where Gaussian processes stand: each applied, an addend of what one channel with normal noise is centred on.
  void processes();
  // One function for all experiments has no hyper-parameter of one.
  void shared_by_all(Process const& process, Span call);
  // Inside the arguments of a process, what a channel predicts is without processes: else they would need themselves.
  void resolve_process_arguments(std::vector<NodeId> const& predicted);
  void place_processes();

  // --- model_widths.cpp
  void positive_widths();
  // Of a parameter that is a width and whose prior gives more than next to nothing to negative values.
  void report_negative_width(NodeId width, std::string const& argument, std::string const& of);
  std::vector<std::string> parameters_of(NodeId root) const;

  // --- model_samples.cpp
  void name_samples();
  // Place holders of samples become what they stand for.
  void finish_samples();
  bool reads_input_rate() const;
  void lay_out_lags(std::vector<NodeId> const& predicted);

  // --- model_quantities.cpp
  void parameters();
  // Each sampled parameter after those its prior refers to.
  void order_priors();
  void channels();
  // The unit of what the noise is centred on, when it is known; a failing expression is reported by the caller's second look.
  // quiet: the model's names, reporting to nobody.
  std::optional<Unit> location_unit(ast::Call const& noise, Scope& quiet);
  void derived();

  ast::Model const& tree_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  Model model_;
  Scope scope_;
  std::vector<std::pair<std::string, StateInfo>> states_;
  ast::TimeDeclaration const* first_time_ = nullptr;
  ast::DiscreteTimeDeclaration const* first_discrete_ = nullptr;
  std::vector<ast::ParameterDeclaration const*> parameter_trees_;
  struct GivenUnknown {
    std::size_t unknown;
    NodeId value;
    Span span;
  };
  std::vector<GivenUnknown> given_unknowns_;         // by `initial`
  std::vector<NodeId> highest_;                      // solutions for the unknowns; none for an implicit model
  std::vector<Invariant> constraints_;               // of every differentiation
  bool orders_doubtful_ = false;                     // after a mistake in the units of an equation: a prime may be missing there
  std::vector<std::optional<NodeId>> initial_lags_;  // of each state of a discrete-time model
  std::vector<std::optional<NodeId>> initial_lag_variances_;
  std::vector<std::pair<Distribution, Quantity>> initial_laws_;
  std::vector<ast::DisturbanceDeclaration const*> disturbance_trees_;
  struct PositiveArgument {
    NodeId node;
    std::string argument;
    std::size_t disturbance;
  };
  std::vector<PositiveArgument> positive_;  // of laws of disturbances
};

}  // namespace sysid
