// Stages, error, and the selections that accept a step, retry it or let an arrived lane rest.
#include "program/embedded.hpp"

#include <limits>

#include "expression/switching.hpp"
#include "program/frozen.hpp"

namespace sysid {

EmbeddedMethod const& dopri5();  // dopri5.cpp

EmbeddedMethod const* find_embedded(std::string_view name) { return name == dopri5().name ? &dopri5() : nullptr; }

namespace {

// A kink this near the beginning or the end of a step, as a part of it, needs no step of its own.
constexpr double near_an_end = 1e-9;
constexpr double most_hunts = 8;
constexpr double no_aim = std::numeric_limits<double>::max();

class Writer {
 public:
  Writer(Graph& graph, std::span<NodeId const> derivative) : graph_(graph) {
    for (std::size_t i = 0; i < derivative.size(); ++i) states_.push_back(graph.leaf(LeafKind::state, static_cast<int>(i)));
    for (SwitchingSurface const& surface : switching_surfaces(graph, derivative))
      if (!surface.at_integers) surfaces_.push_back(surface);
    if (surfaces_.size() > most_surfaces) surfaces_.clear();
    std::vector<NodeId> place_holders;
    for (std::size_t k = 0; k < surfaces_.size(); ++k) place_holders.push_back(stored_side(k));
    derivative_ = frozen(graph, derivative, surfaces_, place_holders);
  }

  Attempt write(EmbeddedMethod const& method) {
    NodeId const zero = number(0), one = number(1);
    NodeId const position = control(Control::position), step = control(Control::step), aim = control(Control::aim),
                 hunts = control(Control::hunts);
    NodeId const active = less(position, one);
    NodeId const length = data(IntervalData::length);
    NodeId const left = graph_.subtract(one, position);
    NodeId const part = graph_.divide(graph_.binary(Operation::minimum, step, aim), length);
    NodeId const last = graph_.binary(Operation::less_equal, left, part);
    NodeId const taken = graph_.select(last, left, part);  // as a part of the interval
    NodeId const h = graph_.multiply(taken, length);
    NodeId const arrived = graph_.select(last, one, graph_.add(position, taken));

    find_sides(position);
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
    NodeId const proposed = graph_.multiply(h, graph_.select(less(badness, number(1e300)), grown, number(0.2)));

    // The first surface that the step crosses, as a part of the step. At its beginning: the lane was on the wrong side and nothing
    // moves; inside: the step is tried again up to there; at its end, or not: the step is taken.
    Crossing const crossing = find_crossing(next, arrived);
    NodeId const at_once = both(crossing.any, graph_.binary(Operation::less_equal, crossing.place, number(near_an_end)));
    NodeId const inside = both(both(crossing.any, graph_.unary(Operation::negation, at_once)),
                               both(less(crossing.place, number(1 - near_an_end)), less(hunts, number(most_hunts))));
    NodeId const trusted = both(active, good);
    NodeId const turning = both(trusted, at_once);
    NodeId const hunting = both(trusted, inside);
    NodeId const accepted =
        both(trusted, graph_.unary(Operation::negation, graph_.binary(Operation::disjunction, at_once, inside)));

    Attempt result;
    for (std::size_t i = 0; i < states_.size(); ++i) result.states.push_back(graph_.select(accepted, next[i], states_[i]));
    // A step cut short by the end of the interval or by a kink says nothing against the longer one.
    NodeId const kept = graph_.select(less(h, step), graph_.binary(Operation::maximum, step, proposed), proposed);
    NodeId const retried = graph_.select(trusted, step, proposed);
    // A little too far: on the other side for certain.
    NodeId const aimed = graph_.multiply(graph_.multiply(crossing.place, number(1 + near_an_end / 2)), h);
    result.control = {graph_.select(accepted, arrived, position),
                      graph_.select(active, graph_.select(accepted, kept, retried), step),
                      graph_.select(hunting, aimed, graph_.select(accepted, number(no_aim), aim)),
                      graph_.select(graph_.binary(Operation::disjunction, hunting, turning), graph_.add(hunts, one),
                                    graph_.select(accepted, zero, hunts))};
    for (std::size_t i = 0; i < states_.size(); ++i)
      result.control.push_back(graph_.binary(Operation::maximum, reached(i), graph_.unary(Operation::absolute, result.states[i])));
    NodeId const changes = graph_.binary(Operation::disjunction, turning, accepted);
    for (std::size_t k = 0; k < surfaces_.size(); ++k)
      result.control.push_back(graph_.select(
          active, graph_.select(both(changes, crossing.each[k]), graph_.negate(sides_[k]), sides_[k]), stored_side(k)));
    return result;
  }

 private:
  NodeId number(double value) { return graph_.constant(value); }
  NodeId control(Control which) { return graph_.leaf(LeafKind::control, static_cast<int>(which)); }
  NodeId rest(std::size_t i) { return graph_.leaf(LeafKind::control, static_cast<int>(Control::rest) + static_cast<int>(i)); }
  NodeId reached(std::size_t state) { return rest(state); }
  NodeId stored_side(std::size_t surface) { return rest(states_.size() + surface); }
  NodeId data(IntervalData which) { return graph_.leaf(LeafKind::interval, static_cast<int>(which)); }
  NodeId less(NodeId a, NodeId b) { return graph_.binary(Operation::less, a, b); }
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
      NodeId const typical = graph_.binary(Operation::maximum, graph_.multiply(number(1e-3), reached(i)), number(1e-9));
      NodeId const near_zero = graph_.select(less(number(0), absolute), absolute, graph_.multiply(relative, typical));
      NodeId const size = graph_.binary(Operation::maximum, graph_.unary(Operation::absolute, states_[i]),
                                        graph_.unary(Operation::absolute, next[i]));
      NodeId const ratio = graph_.divide(errors[i], graph_.add(near_zero, graph_.multiply(relative, size)));
      sum = graph_.add(sum, graph_.multiply(ratio, ratio));
    }
    return graph_.multiply(number(1.0 / static_cast<double>(std::max<std::size_t>(1, errors.size()))), sum);
  }

  struct Crossing {
    NodeId any, place;
    std::vector<NodeId> each;
  };

  // At the beginning of an interval, where an input may have jumped, a lane is where its values say; else where it was left.
  void find_sides(NodeId position) {
    std::vector<NodeId> values;
    for (SwitchingSurface const& surface : surfaces_) values.push_back(surface.value);
    before_ = evaluate(values, states_, position);
    NodeId const beginning =
        both(graph_.binary(Operation::less_equal, position, number(0)), less(control(Control::hunts), number(1)));
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      NodeId const decided = both(beginning, less(number(0), graph_.unary(Operation::absolute, before_[k])));
      sides_.push_back(graph_.select(decided, graph_.unary(Operation::sign, before_[k]), stored_side(k)));
    }
  }

  Crossing find_crossing(std::vector<NodeId> const& next, NodeId arrived) {
    Crossing crossing{number(0), number(2), {}};
    std::vector<NodeId> values;
    for (SwitchingSurface const& surface : surfaces_) values.push_back(surface.value);
    std::vector<NodeId> const after = evaluate(values, next, arrived);
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      NodeId const begin = graph_.multiply(sides_[k], before_[k]), end = graph_.multiply(sides_[k], after[k]);
      NodeId const crossed = less(end, number(0));
      NodeId const place = graph_.select(less(number(0), begin), graph_.divide(begin, graph_.subtract(begin, end)), number(0));
      crossing.each.push_back(crossed);
      crossing.any = graph_.binary(Operation::disjunction, crossing.any, crossed);
      crossing.place = graph_.binary(Operation::minimum, crossing.place, graph_.select(crossed, place, number(2)));
    }
    return crossing;
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
        case LeafKind::control:  // place holders of sides
          return leaf.index >= first_side() ? std::optional(sides_[static_cast<std::size_t>(leaf.index - first_side())])
                                            : std::nullopt;
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

  int first_side() const { return static_cast<int>(Control::rest) + static_cast<int>(states_.size()); }

  Graph& graph_;
  std::vector<SwitchingSurface> surfaces_;
  std::vector<NodeId> states_, derivative_;
  std::vector<NodeId> before_, sides_;  // of the surfaces, where the attempt begins
};

}  // namespace

Attempt attempt(Graph& graph, EmbeddedMethod const& method, std::span<NodeId const> derivative) {
  return Writer(graph, derivative).write(method);
}

}  // namespace sysid
