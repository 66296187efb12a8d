// Leaves in continuous time, states in discrete time.
#include "model/input_errors.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <vector>

#include "expression/affine.hpp"

namespace sysid {
namespace {

using Problem = InputErrorProblem;

bool is_leaf(Node const& node, LeafKind kind, int index) {
  return node.operation == Operation::leaf && node.leaf_kind == kind && node.index == index;
}

class InputError {
 public:
  InputError(Model& model, int input, double sd) : model_(model), input_(input), variance_(sd * sd) {
    Quantity const& measured = model.inputs[static_cast<std::size_t>(input)];
    name_ = fmt::format("error of {}", measured.name);
    if (measured.unit) unit_ = difference(*measured.unit);  // what lies between two temperatures has no zero point
    span_ = measured.span;
  }

  std::optional<Problem> add() {
    if (!model_.processes.empty()) return Problem{Problem::Kind::processes, input_};
    if (!model_.unknowns.empty() || !model_.invariants.empty()) return Problem{Problem::Kind::constraints, input_};
    if (model_.dynamics == Dynamics::none) return Problem{Problem::Kind::no_states, input_};
    return model_.dynamics == Dynamics::discrete ? add_states() : add_leaf();
  }

 private:
  bool reads(NodeId root, LeafKind kind) const {
    return model_.graph.depends(root, [&](Node const& node) { return is_leaf(node, kind, input_); });
  }

  void add_disturbance(int state) {
    Disturbance error;
    error.name = name_;
    error.unit = unit_;
    error.span = span_;
    error.intensity = model_.graph.constant(variance_);
    error.state = state;
    error.held = state < 0;
    model_.disturbances.push_back(std::move(error));
  }

  std::optional<Problem> add_leaf() {
    Graph& graph = model_.graph;
    for (std::size_t c = 0; c < model_.channels.size(); ++c)
      for (NodeId const argument : model_.channels[c].noise.arguments) {
        if (reads(argument, LeafKind::input_rate)) return Problem{Problem::Kind::rate, input_};
        if (reads(argument, LeafKind::input)) return Problem{Problem::Kind::channel, input_, static_cast<int>(c)};
      }
    int const index = static_cast<int>(model_.disturbances.size());
    std::vector<NodeId> derivatives;
    for (State& state : model_.states) {
      if (reads(state.derivative, LeafKind::input_rate)) return Problem{Problem::Kind::rate, input_};
      derivatives.push_back(state.derivative);
    }
    auto const varies = [&](Node const& node) {
      return is_leaf(node, LeafKind::input, input_) ||
             (node.operation == Operation::leaf && node.leaf_kind == LeafKind::disturbance);
    };
    if (auto const node = find_not_affine(graph, derivatives, varies)) return Problem{Problem::Kind::nonlinear, input_, -1, *node};
    for (State& state : model_.states)
      state.derivative = graph.substitute(state.derivative, [&](NodeId leaf) -> std::optional<NodeId> {
        if (!is_leaf(graph[leaf], LeafKind::input, input_)) return std::nullopt;
        return graph.add(leaf, graph.leaf(LeafKind::disturbance, index));
      });
    add_disturbance(-1);
    return std::nullopt;
  }

  int add_state(std::string name, NodeId next) {
    Graph& graph = model_.graph;
    State state;
    state.name = std::move(name);
    state.unit = unit_;
    state.span = span_;
    state.derivative = next;
    state.initial = graph.constant(0);
    state.initial_given = true;
    state.initial_variance = graph.constant(variance_);
    model_.states.push_back(std::move(state));
    return static_cast<int>(model_.states.size()) - 1;
  }

  template <class Visit>
  void each_root(Visit const& visit) {
    for (State& state : model_.states) visit(state.derivative);
    for (Channel& channel : model_.channels)
      for (NodeId& argument : channel.noise.arguments) visit(argument);
    for (Derived& derived : model_.derived) visit(derived.value);
    for (LaggedQuantity& lagged : model_.lagged_quantities) visit(lagged.present);
  }

  std::optional<Problem> add_states() {
    Graph& graph = model_.graph;
    int lags = 0;
    each_root([&](NodeId root) {
      for (NodeId const id : graph.reachable({&root, 1}))
        if (is_leaf(graph[id], LeafKind::input, input_)) lags = std::max(lags, graph[id].lag);
    });
    std::vector<int> states;  // by lag
    states.push_back(add_state(name_, graph.leaf(LeafKind::disturbance, static_cast<int>(model_.disturbances.size()))));
    for (int lag = 1; lag <= lags; ++lag)
      states.push_back(add_state(fmt::format("lag({}, {})", name_, lag), graph.leaf(LeafKind::state, states.back())));
    each_root([&](NodeId& root) {
      root = graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
        Node const node = graph[leaf];
        if (!is_leaf(node, LeafKind::input, input_)) return std::nullopt;
        return graph.add(leaf, graph.leaf(LeafKind::state, states[static_cast<std::size_t>(node.lag)]));
      });
    });
    add_disturbance(states.front());
    return std::nullopt;
  }

  Model& model_;
  int input_;
  double variance_;
  std::string name_;
  std::optional<Unit> unit_;
  Span span_;
};

}  // namespace

std::variant<Model, InputErrorProblem> with_input_errors(Model model, std::span<double const> sd) {
  for (std::size_t i = 0; i < sd.size(); ++i)
    if (sd[i] > 0)
      if (auto const problem = InputError(model, static_cast<int>(i), sd[i]).add()) return *problem;
  return model;
}

}  // namespace sysid
