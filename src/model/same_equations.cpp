// Both graphs from their roots down at once. Operands of a sum or a product stand in any order, which is the order of their making.
#include "model/same_equations.hpp"

#include <algorithm>
#include <map>
#include <optional>

namespace sysid {
namespace {

class Comparison {
 public:
  Comparison(Model const& one, Model const& other) : one_(one), other_(other) {}

  bool same(NodeId a, NodeId b) {
    if (++work_ > most_work) return false;
    Node const& left = one_.graph[a];
    Node const& right = other_.graph[b];
    if (left.operation != right.operation || left.function != right.function) return false;
    if (left.operation == Operation::constant) return left.value == right.value;
    if (left.operation == Operation::leaf) return same_leaf(left, right);
    int const operands = operand_count(left);
    if (operands == 2 && commutes(left.operation)) {
      auto const kept = pairs_;
      if (same(left.a, right.a) && same(left.b, right.b)) return true;
      pairs_ = kept;
      return same(left.a, right.b) && same(left.b, right.a);
    }
    return same(left.a, right.a) && (operands < 2 || same(left.b, right.b)) && (operands < 3 || same(left.c, right.c));
  }

  bool same(std::optional<NodeId> const& a, std::optional<NodeId> const& b) {
    return a.has_value() == b.has_value() && (!a || same(*a, *b));
  }

  bool same(Distribution const& left, Distribution const& right) {
    if (left.row != right.row || left.arguments.size() != right.arguments.size() || !same(left.lower, right.lower) ||
        !same(left.upper, right.upper))
      return false;
    for (std::size_t k = 0; k < left.arguments.size(); ++k)
      if (!same(left.arguments[k], right.arguments[k])) return false;
    return true;
  }

  Likeness likeness() {
    Likeness found{{pairs_.begin(), pairs_.end()}};
    for (auto const& [i, j] : found.parameters) {
      Parameter const& left = one_.parameters[static_cast<std::size_t>(i)];
      Parameter const& right = other_.parameters[static_cast<std::size_t>(j)];
      found.same_names = found.same_names && left.name == right.name;
      found.same_priors = found.same_priors && (!left.prior || same(*left.prior, *right.prior));
    }
    return found;
  }

 private:
  static constexpr int most_work = 100'000;

  static bool commutes(Operation operation) {
    return operation == Operation::add || operation == Operation::multiply || operation == Operation::equal ||
           operation == Operation::conjunction || operation == Operation::disjunction;
  }

  bool same_leaf(Node const& left, Node const& right) {
    if (left.leaf_kind != right.leaf_kind || left.lag != right.lag || left.stage != right.stage) return false;
    auto const i = static_cast<std::size_t>(left.index), j = static_cast<std::size_t>(right.index);
    switch (left.leaf_kind) {
      case LeafKind::parameter:
        return same_parameter(left.index, right.index);
      case LeafKind::input:
      case LeafKind::input_rate:
        return one_.inputs[i].name == other_.inputs[j].name;
      case LeafKind::measured:
        return one_.channels[i].name == other_.channels[j].name;
      default:
        return left.index == right.index;
    }
  }

  bool same_parameter(int i, int j) {
    Parameter const& left = one_.parameters[static_cast<std::size_t>(i)];
    Parameter const& right = other_.parameters[static_cast<std::size_t>(j)];
    if (left.prior.has_value() != right.prior.has_value() || left.per_experiment != right.per_experiment) return false;
    for (auto const& [of_one, of_other] : pairs_)
      if ((of_one == i) != (of_other == j)) return false;
    if (pairs_.contains(i)) return true;
    if (!left.prior && !same(left.value, right.value)) return false;
    pairs_[i] = j;
    return true;
  }

  Model const& one_;
  Model const& other_;
  std::map<int, int> pairs_;
  int work_ = 0;
};

bool comparable(Model const& model) {
  return model.processes.empty() && model.expansions.empty() && model.unknowns.empty() && !model.implicit &&
         model.residuals.empty() && model.invariants.empty();
}

}  // namespace

std::optional<Likeness> same_equations(Model const& one, Model const& other) {
  if (!comparable(one) || !comparable(other)) return {};
  if (one.dynamics != other.dynamics || one.step != other.step || one.states.size() != other.states.size() ||
      one.channels.size() != other.channels.size() || one.disturbances.size() != other.disturbances.size() ||
      one.memories.size() != other.memories.size())
    return {};
  Comparison comparison(one, other);
  for (std::size_t s = 0; s < one.states.size(); ++s)
    if (!comparison.same(one.states[s].derivative, other.states[s].derivative) ||
        !comparison.same(one.states[s].initial, other.states[s].initial) ||
        !comparison.same(one.states[s].initial_variance, other.states[s].initial_variance))
      return {};
  for (std::size_t d = 0; d < one.disturbances.size(); ++d)
    if (one.disturbances[d].state != other.disturbances[d].state || one.disturbances[d].held != other.disturbances[d].held ||
        !comparison.same(one.disturbances[d].intensity, other.disturbances[d].intensity))
      return {};
  for (std::size_t m = 0; m < one.memories.size(); ++m)
    if (!comparison.same(one.memories[m], other.memories[m])) return {};
  for (Channel const& channel : one.channels) {
    auto const same_name = std::ranges::find_if(other.channels, [&](Channel const& each) { return each.name == channel.name; });
    if (same_name == other.channels.end() || !comparison.same(channel.noise, same_name->noise)) return {};
  }
  return comparison.likeness();
}

}  // namespace sysid
