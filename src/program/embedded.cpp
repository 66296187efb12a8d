// Stages, error, and the selections that accept a step, retry it or let an arrived lane rest.
#include "program/embedded.hpp"

#include <limits>

namespace sysid {

EmbeddedMethod const& dopri5();  // dopri5.cpp

EmbeddedMethod const* find_embedded(std::string_view name) { return name == dopri5().name ? &dopri5() : nullptr; }

namespace {

// A kink this near the beginning or the end of a step, as a part of it, needs no step of its own.
constexpr double near_an_end = 1e-6;
constexpr double most_hunts = 6;
constexpr double no_aim = std::numeric_limits<double>::max();

class Writer {
 public:
  Writer(Graph& graph, std::span<NodeId const> derivative, std::span<NodeId const> surfaces)
      : graph_(graph), derivative_(derivative), surfaces_(surfaces) {
    for (std::size_t i = 0; i < derivative.size(); ++i) states_.push_back(graph.leaf(LeafKind::state, static_cast<int>(i)));
  }

  Attempt write(EmbeddedMethod const& method) {
    NodeId const zero = number(0), one = number(1);
    NodeId const position = control(Control::position), step = control(Control::step), aim = control(Control::aim),
                 hunts = control(Control::hunts);
    NodeId const active = graph_.binary(Operation::less, position, one);
    NodeId const length = data(IntervalData::length);
    NodeId const wanted = graph_.binary(Operation::minimum, step, aim);
    NodeId const left = graph_.subtract(one, position);
    NodeId const part = graph_.divide(wanted, length);
    NodeId const last = graph_.binary(Operation::less_equal, left, part);
    NodeId const taken = graph_.select(last, left, part);  // as a part of the interval
    NodeId const h = graph_.multiply(taken, length);
    NodeId const arrived = graph_.select(last, one, graph_.add(position, taken));

    std::vector<std::vector<NodeId>> slopes;
    for (std::size_t i = 0; i < method.c.size(); ++i)
      slopes.push_back(evaluate(derivative_, advanced(slopes, method.a[i], h), along(position, taken, method.c[i], arrived)));
    std::vector<NodeId> const next = advanced(slopes, method.b, h);
    NodeId const badness = mean_square(errors(slopes, method.e, h), next);

    // x <= 1 is false for NaN, so an attempt that leaves the finite numbers is retried with the smallest factor.
    NodeId const good = graph_.binary(Operation::less_equal, badness, one);
    NodeId const root = graph_.power(graph_.binary(Operation::maximum, badness, number(1e-20)), number(-0.5 / method.order));
    NodeId const grown = graph_.binary(Operation::minimum, number(5),
                                       graph_.binary(Operation::maximum, number(0.2), graph_.multiply(number(0.9), root)));
    NodeId const finite = graph_.binary(Operation::less, badness, number(1e300));
    NodeId const proposed = graph_.multiply(h, graph_.select(finite, grown, number(0.2)));

    // The first kink inside the step, as a part of it; 2: none.
    NodeId const crossing = first_crossing(next, position, arrived);
    NodeId const inside = both(graph_.binary(Operation::less, crossing, number(1 - near_an_end)),
                               graph_.binary(Operation::less, hunts, number(most_hunts)));
    NodeId const accepted = both(active, both(good, graph_.unary(Operation::negation, inside)));
    NodeId const hunting = both(active, both(good, inside));

    Attempt result;
    for (std::size_t i = 0; i < states_.size(); ++i) result.states.push_back(graph_.select(accepted, next[i], states_[i]));
    // A step cut short by the end of the interval or by a kink says nothing against the longer one.
    NodeId const cut = graph_.binary(Operation::less, h, step);
    NodeId const kept = graph_.select(cut, graph_.binary(Operation::maximum, step, proposed), proposed);
    NodeId const retried = graph_.select(hunting, step, proposed);
    result.control = {graph_.select(accepted, arrived, position),
                      graph_.select(active, graph_.select(accepted, kept, retried), step),
                      graph_.select(hunting, graph_.multiply(crossing, h), graph_.select(accepted, number(no_aim), aim)),
                      graph_.select(hunting, graph_.add(hunts, one), graph_.select(accepted, zero, hunts))};
    for (std::size_t i = 0; i < states_.size(); ++i) {
      NodeId const reached = control_of_state(i);
      NodeId const size = graph_.unary(Operation::absolute, result.states[i]);
      result.control.push_back(graph_.binary(Operation::maximum, reached, size));
    }
    return result;
  }

 private:
  NodeId number(double value) { return graph_.constant(value); }
  NodeId control(Control which) { return graph_.leaf(LeafKind::control, static_cast<int>(which)); }
  NodeId control_of_state(std::size_t i) {
    return graph_.leaf(LeafKind::control, static_cast<int>(Control::reached) + static_cast<int>(i));
  }
  NodeId data(IntervalData which) { return graph_.leaf(LeafKind::interval, static_cast<int>(which)); }
  NodeId both(NodeId a, NodeId b) { return graph_.binary(Operation::conjunction, a, b); }

  // The position c of the way through the step.
  NodeId along(NodeId position, NodeId taken, double c, NodeId arrived) {
    if (c == 0) return position;
    if (c == 1) return arrived;
    return graph_.add(position, graph_.multiply(number(c), taken));
  }

  NodeId weighted(std::vector<std::vector<NodeId>> const& slopes, std::vector<double> const& weights, std::size_t state) {
    NodeId sum = number(0);
    for (std::size_t j = 0; j < weights.size(); ++j)
      if (weights[j] != 0) sum = graph_.add(sum, graph_.multiply(number(weights[j]), slopes[j][state]));
    return sum;
  }

  std::vector<NodeId> advanced(std::vector<std::vector<NodeId>> const& slopes, std::vector<double> const& weights, NodeId h) {
    std::vector<NodeId> result;
    for (std::size_t i = 0; i < states_.size(); ++i)
      result.push_back(graph_.add(states_[i], graph_.multiply(h, weighted(slopes, weights, i))));
    return result;
  }

  std::vector<NodeId> errors(std::vector<std::vector<NodeId>> const& slopes, std::vector<double> const& weights, NodeId h) {
    std::vector<NodeId> result;
    for (std::size_t i = 0; i < states_.size(); ++i) result.push_back(graph_.multiply(h, weighted(slopes, weights, i)));
    return result;
  }

  NodeId mean_square(std::vector<NodeId> const& errors, std::vector<NodeId> const& next) {
    NodeId const relative = data(IntervalData::relative), absolute = data(IntervalData::absolute);
    NodeId sum = number(0);
    for (std::size_t i = 0; i < errors.size(); ++i) {
      NodeId const reached = graph_.binary(Operation::maximum, graph_.multiply(number(1e-3), control_of_state(i)), number(1e-9));
      NodeId const near_zero =
          graph_.select(graph_.binary(Operation::less, number(0), absolute), absolute, graph_.multiply(relative, reached));
      NodeId const size = graph_.binary(Operation::maximum, graph_.unary(Operation::absolute, states_[i]),
                                        graph_.unary(Operation::absolute, next[i]));
      NodeId const ratio = graph_.divide(errors[i], graph_.add(near_zero, graph_.multiply(relative, size)));
      sum = graph_.add(sum, graph_.multiply(ratio, ratio));
    }
    return graph_.multiply(number(1.0 / static_cast<double>(std::max<std::size_t>(1, errors.size()))), sum);
  }

  NodeId first_crossing(std::vector<NodeId> const& next, NodeId position, NodeId arrived) {
    NodeId first = number(2);
    if (surfaces_.empty()) return first;
    std::vector<NodeId> const before = evaluate(surfaces_, states_, position), after = evaluate(surfaces_, next, arrived);
    for (std::size_t k = 0; k < before.size(); ++k) {
      NodeId const changes = graph_.binary(Operation::less, graph_.multiply(before[k], after[k]), number(0));
      NodeId const place = graph_.divide(before[k], graph_.subtract(before[k], after[k]));
      NodeId const counts = both(changes, graph_.binary(Operation::less, number(near_an_end), place));
      first = graph_.binary(Operation::minimum, first, graph_.select(counts, place, number(2)));
    }
    return first;
  }

  // Expressions at other states and another position in the interval.
  std::vector<NodeId> evaluate(std::span<NodeId const> roots, std::vector<NodeId> const& states, NodeId position) {
    return graph_.substitute(roots, [&](NodeId id) -> std::optional<NodeId> {
      Node const leaf = graph_[id];
      switch (leaf.leaf_kind) {
        case LeafKind::state:
          return states[static_cast<std::size_t>(leaf.index)];
        case LeafKind::input:
          return polynomial(leaf.index, position, false);
        case LeafKind::input_rate:
          return graph_.divide(polynomial(leaf.index, position, true), data(IntervalData::length));
        case LeafKind::time:
          return graph_.add(data(IntervalData::begin), graph_.multiply(data(IntervalData::length), position));
        default:
          return std::nullopt;
      }
    });
  }

  // Horner's form of an input's polynomial on the interval, or of its derivative.
  NodeId polynomial(int input, NodeId position, bool derivative) {
    NodeId sum = number(0);
    for (int power = largest_input_degree; power >= (derivative ? 1 : 0); --power) {
      NodeId const coefficient = graph_.leaf(LeafKind::coefficient, input * (largest_input_degree + 1) + power);
      NodeId const term = derivative ? graph_.multiply(number(power), coefficient) : coefficient;
      sum = power == largest_input_degree ? term : graph_.add(graph_.multiply(sum, position), term);
    }
    return sum;
  }

  Graph& graph_;
  std::span<NodeId const> derivative_, surfaces_;
  std::vector<NodeId> states_;
};

}  // namespace

Attempt attempt(Graph& graph, EmbeddedMethod const& method, std::span<NodeId const> derivative, std::span<NodeId const> surfaces) {
  return Writer(graph, derivative, surfaces).write(method);
}

}  // namespace sysid
