// The checked model: typed, first order, no text left but names and spans. Everything numeric is in coherent SI units.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "distribution/distribution.hpp"
#include "expression/graph.hpp"
#include "model/expansion.hpp"
#include "model/process.hpp"
#include "model/quantity.hpp"

namespace sysid {

/// How a model goes from one sample to the next.
enum class Dynamics {
  continuous,  // by differential equations, which need times and what inputs do between samples
  discrete,    // by a map from sample to sample
  none,        // not at all: no states, rows are independent and of any order
};

/// One component of the first-order system: leaf state(i).
struct State : Quantity {  // named "y", "y'", "y''", ...; in discrete time "lag(y, 1)", "lag(y, 2)", ...
  NodeId derivative = 0;   // expression in state, input, parameter, time leaves; in discrete time the component's next value
  NodeId initial = 0;      // expression in parameters only; in discrete time also measured leaves with a lag
  bool initial_given = false;
  std::optional<NodeId> initial_variance;  // of a random initial value, `initial` is its mean: expression in parameters only, SI
};

/// What moves the states and is not measured: leaf disturbance(i), white noise of mean 0 that derivatives read linearly; in
/// discrete time independent from sample to sample. A disturbance with a memory is a state besides, which reads the leaf.
struct Disturbance : Quantity {
  NodeId intensity = 0;  // q of its autocovariance q*delta(t), SI; in discrete time its variance: expression in parameters only
  int state = -1;        // that is the disturbance as equations see it; -1: the leaf itself
  bool held = false;  // in continuous time: one value from sample to sample, as an error of an input; `intensity` is its variance
};

/// Leaf parameter(i). Sampled when it has a prior, else fixed at `value`. `per_experiment`: every experiment has its own; a data
/// block may fix it there, must where there is neither prior nor value.
struct Parameter : Quantity {
  bool per_experiment = false;
  std::optional<Distribution> prior;  // arguments and bounds are SI expressions of constants and other parameters
  std::optional<NodeId> value;        // a constant expression
  bool coefficient = false;           // of an expansion

  /// The value that it has in all experiments, where it is fixed.
  std::optional<NodeId> value_of_all() const { return per_experiment ? std::nullopt : value; }
};

/// What is measured: leaf measured(i) is its sample.
struct Channel : Quantity {
  Distribution noise;
};

/// A quantity of interest. Per sample when it reads states, inputs or time.
struct Derived : Quantity {
  NodeId value = 0;
  bool per_sample = false;
};

/// Something whose unit could not be compared with others: a name that declares none, or an expression.
struct Unchecked {
  std::string what;  // as written
  Span span;
  std::string why;
};

/// Of a discrete-time model: what may have a past, a state or what a channel predicts. `registers` are the states that hold its
/// lags 1, 2, ...
struct LaggedQuantity : Quantity {
  NodeId present = 0;  // its value at the present sample
  int channel = -1;    // of which it is the prediction
  std::vector<int> registers;
};

/// What the equations determine beside the states, leaf unknown(i): a quantity that is never differentiated, or the highest
/// derivative of a state.
struct Unknown : Quantity {
  int component = -1;  // the state whose derivative it is; -1: an algebraic unknown
  NodeId guess = 0;    // where the search for its first value begins: an expression in parameters only
};

/// An equation that was differentiated in time to reach index 1. It holds along every solution that starts in it, but for the drift
/// of the integration.
struct Invariant {
  NodeId value = 0;  // zero, but for the drift
  NodeId size = 0;   // of its terms, which the drift is compared with: sum |d value/d q * q| over the states and parameters q
  Span span;
};

/// Why a model cannot be written as y' = f(t, y).
struct Implicit {
  Span equation;
  std::string unknown;  // that it is not linear in
};

struct Model {
  std::string name;
  std::string title;
  Dynamics dynamics = Dynamics::continuous;
  std::optional<double> step;  // [s] between samples of a discrete-time model; absent: what the data have
  Graph graph;
  std::vector<Quantity> inputs;
  std::vector<State> states;
  std::vector<Parameter> parameters;  // in the user's order
  std::vector<int> sampling_order;    // sampled parameters, each after those its prior refers to
  std::vector<Channel> channels;
  std::vector<Process> processes;
  std::vector<Expansion> expansions;
  std::vector<Derived> derived;
  std::vector<Unchecked> unchecked;  // in the order of the text
  std::vector<LaggedQuantity> lagged_quantities;
  std::vector<Disturbance> disturbances;
  std::vector<NodeId> memories;  // leaf previous(i): the value that memories[i] had at the sample before, at the first its own

  // Where an unknown is algebraic, or cannot be solved for; else empty. Residuals are zero, of index 1, as many as unknowns. Where
  // all could be solved for, the states' derivatives, channels and derived quantities read the solutions, not the unknowns.
  std::vector<Unknown> unknowns;
  std::vector<NodeId> residuals;
  std::vector<Invariant> invariants;
  std::optional<Implicit> implicit;

  /// Whether a solver integrates it, so that substeps mean something.
  bool integrated() const { return dynamics == Dynamics::continuous && !states.empty(); }
  /// Whether states are random given the parameters: then the likelihood is that of a filter.
  bool filtered() const {
    if (!disturbances.empty()) return true;
    for (State const& each : states)
      if (each.initial_variance) return true;
    return false;
  }
  /// The first parameter whose prior cannot be drawn from; null where all can.
  Parameter const* improper() const {
    for (Parameter const& each : parameters)
      if (each.prior && !each.prior->row->proper) return &each;
    return nullptr;
  }
};

}  // namespace sysid
