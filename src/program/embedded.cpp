// Stages, error, and the selections that accept a step, retry it or let an arrived lane rest.
#include "program/embedded.hpp"

#include <algorithm>
#include <limits>

#include "expression/function.hpp"
#include "expression/switching.hpp"
#include "program/frozen.hpp"
#include "solver/solver.hpp"

namespace sysid {

namespace {

// A kink this near the beginning or the end of a step, as a part of it, needs no step of its own.
constexpr double near_an_end = 1e-9;
constexpr double most_hunts = 8;
constexpr double no_aim = std::numeric_limits<double>::max();

// A condition that is never NaN, for what must go on beyond a failed attempt.
double is_number(double a) { return a == a ? 1 : 0; }
void is_number_lanes(double const* a, double* out, int width) {
  for (int w = 0; w < width; ++w) out[w] = is_number(a[w]);
}
constexpr Function is_number_function{"is_number", 1, &is_number, &is_number_lanes, nullptr, nullptr, nullptr};

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
    for (std::size_t i = 0; i < method.c.size(); ++i) {
      NodeId const place = along(position, taken, method.c[i], arrived);
      slopes.push_back(evaluate(derivative_, advanced(slopes, method.a[i], h), place));
    }
    std::vector<NodeId> const next = advanced(slopes, method.b, h);
    NodeId const square = mean_square(errors(slopes, method.e, h), next);
    std::vector<NodeId> const after = surface_values(next, arrived);
    // An attempt that leaves what can be computed is retried with the smallest factor.
    NodeId const badness = graph_.select(is_number_of(square), square, number(no_aim));
    NodeId const good = graph_.binary(Operation::less_equal, badness, one);
    NodeId const root = graph_.power(graph_.binary(Operation::maximum, badness, number(1e-20)), number(-0.5 / method.order));
    NodeId const grown = graph_.binary(Operation::minimum, number(5),
                                       graph_.binary(Operation::maximum, number(0.2), graph_.multiply(number(0.9), root)));
    NodeId const proposed = graph_.multiply(h, graph_.select(less(badness, number(1e300)), grown, number(0.2)));

    // The first surface that the step crosses, as a part of the step. At its beginning: the lane was on the wrong side of that one
    // and nothing moves; inside: the step is tried again up to there; at its end, or not: the step is taken.
    Crossing const crossing = find_crossing(after, slopes.front(), position, h);
    NodeId const at_once = both(crossing.any, graph_.binary(Operation::less_equal, crossing.place, number(near_an_end)));
    NodeId const may_hunt = less(hunts, number(most_hunts)), before_end = less(crossing.place, number(1 - near_an_end)),
                 worth_it = both(before_end, may_hunt);
    NodeId const inside = both(both(crossing.any, graph_.unary(Operation::negation, at_once)), worth_it);
    NodeId const trusted = both(active, good);
    NodeId const turning = both(trusted, at_once);
    NodeId const hunting = both(trusted, inside);
    NodeId const accepted =
        both(trusted, graph_.unary(Operation::negation, graph_.binary(Operation::disjunction, at_once, inside)));

    Attempt result;
    for (std::size_t i = 0; i < states_.size(); ++i) result.states.push_back(graph_.select(accepted, next[i], states_[i]));
    // A step cut short by the end of the interval or by a kink says nothing against the longer one.
    NodeId const longer = graph_.binary(Operation::maximum, step, proposed);
    NodeId const kept = graph_.select(less(h, step), longer, proposed);
    NodeId const retried = graph_.select(trusted, step, proposed);
    // A little too far: on the other side for certain.
    NodeId const aimed = graph_.multiply(graph_.multiply(crossing.place, number(1 + near_an_end / 2)), h);
    result.control = {graph_.select(accepted, arrived, position),
                      graph_.select(active, graph_.select(accepted, kept, retried), step),
                      graph_.select(hunting, aimed, graph_.select(accepted, number(no_aim), aim))};
    NodeId const same = graph_.select(accepted, zero, hunts), more = graph_.add(hunts, one);
    result.control.push_back(graph_.select(graph_.binary(Operation::disjunction, hunting, turning), more, same));
    for (std::size_t i = 0; i < states_.size(); ++i) {
      NodeId const size = graph_.unary(Operation::absolute, result.states[i]);
      result.control.push_back(graph_.binary(Operation::maximum, reached(i), size));
    }
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      // A lane that turns has not come to the surfaces that this step would have crossed later.
      NodeId const turned = both(turning, graph_.binary(Operation::less_equal, crossing.places[k], number(near_an_end)));
      NodeId const changes = both(graph_.binary(Operation::disjunction, turned, accepted), crossing.each[k]);
      result.control.push_back(graph_.select(active, graph_.select(changes, graph_.negate(sides_[k]), sides_[k]), stored_side(k)));
    }
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
  NodeId is_number_of(NodeId a) { return graph_.call(is_number_function, a); }
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
    int moving = 0;
    for (std::size_t i = 0; i < errors.size(); ++i) {
      if (graph_.is_constant(errors[i], 0)) continue;  // what is remembered has no error that could make up for another's
      ++moving;
      NodeId const typical = graph_.multiply(number(1e-3), graph_.binary(Operation::maximum, reached(i), number(smallest_size)));
      NodeId const by_default = graph_.multiply(relative, typical);
      NodeId const near_zero = graph_.select(less(number(0), absolute), absolute, by_default);
      NodeId const size_then = graph_.unary(Operation::absolute, next[i]), size_now = graph_.unary(Operation::absolute, states_[i]);
      NodeId const size = graph_.binary(Operation::maximum, size_now, size_then);
      NodeId const ratio = graph_.divide(errors[i], graph_.add(near_zero, graph_.multiply(relative, size)));
      sum = graph_.add(sum, graph_.multiply(ratio, ratio));
    }
    return graph_.multiply(number(1.0 / std::max(1, moving)), sum);
  }

  struct Crossing {
    NodeId any, place;                 // of the first crossing, as a part of the step
    std::vector<NodeId> each, places;  // of the surfaces: whether it is crossed, and where
  };

  // At the beginning of an interval, where an input may have jumped, a lane is where its values say; else where it was left.
  void find_sides(NodeId position) {
    before_ = surface_values(states_, position);
    NodeId const fresh = less(control(Control::hunts), number(1));
    NodeId const beginning = both(graph_.binary(Operation::less_equal, position, number(0)), fresh);
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      NodeId const away = less(number(0), graph_.unary(Operation::absolute, before_[k]));
      NodeId const moved = both(is_number_of(before_[k]), away);
      NodeId const decided = both(beginning, moved);
      sides_.push_back(graph_.select(decided, graph_.unary(Operation::sign, before_[k]), stored_side(k)));
    }
  }

  std::vector<NodeId> surface_values(std::vector<NodeId> const& states, NodeId position) {
    std::vector<NodeId> values;
    for (SwitchingSurface const& surface : surfaces_) values.push_back(surface.value);
    return evaluate(values, states, position);
  }

  Crossing find_crossing(std::vector<NodeId> const& after, std::vector<NodeId> const& slopes, NodeId position, NodeId h) {
    Crossing crossing{number(0), number(2), {}, {}};
    std::vector<NodeId> const rates = surface_rates(slopes, position);
    for (std::size_t k = 0; k < surfaces_.size(); ++k) {
      NodeId const begin = graph_.multiply(sides_[k], before_[k]), end = graph_.multiply(sides_[k], after[k]);
      // A surface without a value belongs to a branch that is not taken: where it is, the slopes have none either.
      NodeId const beyond = less(end, number(0)), crossed = both(is_number_of(end), beyond);
      NodeId const place = zero_of_parabola(begin, graph_.multiply(sides_[k], graph_.multiply(h, rates[k])), end);
      crossing.each.push_back(crossed);
      crossing.places.push_back(place);
      crossing.any = graph_.binary(Operation::disjunction, crossing.any, crossed);
      crossing.place = graph_.binary(Operation::minimum, crossing.place, graph_.select(crossed, place, number(2)));
    }
    return crossing;
  }

  // Where b + r p + c p^2 leaves the positive numbers for good on its way to `end` < 0 at p = 1; 0 where it begins among the
  // negative ones. The slope tells a lane that has just come here, and will be back before the step is over, from one that turns.
  NodeId zero_of_parabola(NodeId b, NodeId r, NodeId end) {
    NodeId const c = graph_.subtract(graph_.subtract(end, b), r);
    NodeId const four_times = graph_.multiply(number(4), graph_.multiply(c, b));
    NodeId const root = graph_.unary(Operation::square_root, graph_.subtract(graph_.multiply(r, r), four_times));
    // Twice the same root, each without cancellation. c < 0 where r >= 0.
    NodeId const below_rising = graph_.multiply(number(-2), c), rising = graph_.divide(graph_.add(r, root), below_rising);
    NodeId const below_falling = graph_.subtract(root, r), falling = graph_.divide(graph_.multiply(number(2), b), below_falling);
    NodeId const place = graph_.select(less(r, number(0)), falling, rising);
    // The line where a slope has no value.
    NodeId const line = graph_.divide(b, graph_.subtract(b, end));
    NodeId const inside = graph_.select(is_number_of(place), place, line);
    return graph_.select(less(b, number(0)), number(0), inside);
  }

  // Time derivatives of the surfaces where the attempt begins.
  std::vector<NodeId> surface_rates(std::vector<NodeId> const& slopes, NodeId position) {
    std::vector<NodeId> rates;
    for (SwitchingSurface const& surface : surfaces_) {
      NodeId sum = number(0);
      for (NodeId const id : graph_.reachable({&surface.value, 1})) {
        Node const leaf = graph_[id];
        if (leaf.operation != Operation::leaf) continue;
        std::optional<NodeId> rate;
        if (leaf.leaf_kind == LeafKind::state) rate = slopes[static_cast<std::size_t>(leaf.index)];
        if (leaf.leaf_kind == LeafKind::time) rate = number(1);
        if (leaf.leaf_kind == LeafKind::input) rate = input(leaf.index, position, 1);
        if (leaf.leaf_kind == LeafKind::input_rate) rate = input(leaf.index, position, 2);
        if (!rate) continue;
        NodeId const slope = graph_.differentiate(surface.value, id);
        sum = graph_.add(sum, graph_.multiply(evaluate({&slope, 1}, states_, position).front(), *rate));
      }
      rates.push_back(sum);
    }
    return rates;
  }

  // Expressions at other states and another position in the interval.
  std::vector<NodeId> evaluate(std::span<NodeId const> roots, std::vector<NodeId> const& states, NodeId position) {
    return graph_.substitute(roots, [&](NodeId id) -> std::optional<NodeId> {
      Node const leaf = graph_[id];
      switch (leaf.leaf_kind) {
        case LeafKind::state:
          return states[static_cast<std::size_t>(leaf.index)];
        case LeafKind::input:
          return input(leaf.index, position, 0);
        case LeafKind::input_rate:
          return input(leaf.index, position, 1);
        case LeafKind::time: {
          NodeId const since = graph_.multiply(data(IntervalData::length), position);
          return graph_.add(data(IntervalData::begin), since);
        }
        case LeafKind::control:  // place holders of sides
          return leaf.index >= first_side() ? std::optional(sides_[static_cast<std::size_t>(leaf.index - first_side())])
                                            : std::nullopt;
        default:
          return std::nullopt;
      }
    });
  }

  // An input, or its first or second time derivative: Horner's form of its polynomial on the interval.
  NodeId input(int index, NodeId position, int derivative) {
    NodeId sum = number(0);
    for (int power = largest_input_degree; power >= derivative; --power) {
      double factor = 1;
      for (int k = 0; k < derivative; ++k) factor *= power - k;
      NodeId const coefficient = graph_.leaf(LeafKind::coefficient, index * (largest_input_degree + 1) + power);
      NodeId const term = graph_.multiply(number(factor), coefficient);
      sum = power == largest_input_degree ? term : graph_.add(graph_.multiply(sum, position), term);
    }
    for (int k = 0; k < derivative; ++k) sum = graph_.divide(sum, data(IntervalData::length));
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
