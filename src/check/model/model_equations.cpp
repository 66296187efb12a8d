// Equations to residuals, reduced to index one and solved for the highest derivatives; what is missing or too much is said by name.
#include "check/model/model_checker.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "check/expression/names_used.hpp"
#include "check/message/errors.hpp"
#include "check/model/determined.hpp"
#include "model/index_reduction.hpp"
#include "model/invariant.hpp"
#include "model/reduction.hpp"

namespace sysid {

namespace {

/// `real<lower=0> m` of other languages, which reads like an equation of comparisons.
ast::Name const* type_of_declaration(ast::Equation const& equation) {
  auto const* left = std::get_if<ast::Box<ast::Binary>>(&equation.left.node);
  auto const* right = std::get_if<ast::Box<ast::Binary>>(&equation.right.node);
  if (left == nullptr || right == nullptr || (*left)->symbol != "<" || (*right)->symbol != ">") return nullptr;
  auto const* type = std::get_if<ast::Reference>(&(*left)->left->node);
  return type != nullptr && (type->name.text == "real" || type->name.text == "int") ? &type->name : nullptr;
}

}  // namespace

void ModelChecker::equations() {
  std::vector<ast::Equation const*> trees;
  std::vector<NodeId> residuals, right;
  bool good = true;
  Graph& graph = model_.graph;
  each<ast::Equation>([&](ast::Equation const& equation) {
    ast::Name const* const type = type_of_declaration(equation);
    if (type != nullptr && scope_.find(type->text) == nullptr) {
      diagnostics_.add(errors::unknown_name(*type, scope_.names()));
      good = false;
      return;
    }
    auto const sides = scope_.equation(equation);
    if (!sides) {
      good = false;
      return;
    }
    orders_doubtful_ = orders_doubtful_ || sides->first.kind == Typed::Kind::wrong || sides->second.kind == Typed::Kind::wrong;
    trees.push_back(&equation);
    right.push_back(sides->second.node);
    residuals.push_back(graph.subtract(sides->second.node, sides->first.node));
    graph.set_span(residuals.back(), equation.span);
  });
  if (!good) {
    report_unmentioned_states();
    return;
  }
  good = reduce_to_index_one(trees, residuals);
  if (!good || failed()) return;
  auto const solved = solve_for_unknowns(graph, residuals);
  auto const* failure = std::get_if<ReductionFailure>(&solved);
  std::optional<int> open = undetermined_unknown(graph, residuals);
  if (failure != nullptr && failure->kind == ReductionFailure::Kind::singular) open = failure->unknown;
  if (open) {
    auto const& [name, info] = states_[static_cast<std::size_t>(*open)];
    diagnostics_.add(errors::undetermined(info.declaration->name.span, primed_name(name, info.order)));
    return;
  }
  if (failure != nullptr && scope_.samples().discrete) {
    auto const equation = static_cast<std::size_t>(failure->equation), unknown = static_cast<std::size_t>(failure->unknown);
    diagnostics_.add(errors::implicit_in_discrete_time(trees[equation]->span, states_[unknown].first));
    return;
  }
  if (failure != nullptr)
    model_.implicit = Implicit{trees[static_cast<std::size_t>(failure->equation)]->span,
                               unknown_name(static_cast<std::size_t>(failure->unknown))};
  else
    highest_ = std::get<std::vector<NodeId>>(solved);
  if (scope_.samples().discrete) {  // they are the states at the present sample
    report_forgotten_lags(trees, residuals, right);
    return;
  }
  bool const algebraic = std::any_of(states_.begin(), states_.end(), [](auto const& each) { return each.second.order == 0; });
  if (algebraic || model_.implicit) model_.residuals = residuals;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    StateInfo const& info = states_[i].second;
    for (int k = 0; k + 1 < info.order; ++k)
      model_.states[static_cast<std::size_t>(info.first + k)].derivative = graph.leaf(LeafKind::state, info.first + k + 1);
    NodeId const top = model_.implicit ? graph.leaf(LeafKind::unknown, static_cast<int>(i)) : highest_[i];
    if (info.order > 0) model_.states[static_cast<std::size_t>(info.first + info.order - 1)].derivative = top;
    if (model_.residuals.empty()) continue;
    Unknown unknown;
    unknown.name = unknown_name(i);
    unknown.unit = rate_unit(scope_.find(states_[i].first)->unit, info.order);
    unknown.span = info.declaration->name.span;
    unknown.component = info.order > 0 ? info.first + info.order - 1 : -1;
    unknown.guess = graph.constant(0);
    model_.unknowns.push_back(std::move(unknown));
  }
}

void ModelChecker::report_forgotten_lags(std::vector<ast::Equation const*> const& trees, std::vector<NodeId> const& residuals,
                                         std::vector<NodeId> const& right) {
  Graph const& graph = model_.graph;
  std::vector<NodeId> const read = graph.reachable(residuals);
  for (std::size_t e = 0; e < trees.size(); ++e) {
    auto const* given = std::get_if<ast::Reference>(&trees[e]->left.node);
    StateInfo const* const state = given != nullptr ? find_state(given->name.text) : nullptr;
    if (state == nullptr) continue;
    auto const of_state = [index = static_cast<int>(index_of(*state))](LeafKind kind) {
      return [kind, index](Node const& node) { return is_leaf(node, kind) && node.index == index; };
    };
    auto const is_past = of_state(LeafKind::previous);
    if (std::ranges::none_of(read, [&](NodeId id) { return is_past(graph[id]); }) &&
        graph.depends(right[e], of_state(LeafKind::unknown)))
      diagnostics_.add_once(errors::forgotten_lag(trees[e]->span, given->name.text.substr(0, given->name.text.find('['))));
  }
}

std::string ModelChecker::unknown_name(std::size_t state) const {
  return primed_name(states_[state].first, states_[state].second.order);
}

bool ModelChecker::may_be_algebraic(std::string const& name, StateInfo const& info) {
  return info.order == 0 && initial_primes(name) < 1 && mentioned(name) &&
         std::any_of(states_.begin(), states_.end(), [](auto const& each) { return each.second.order > 0; });
}

bool ModelChecker::reduce_to_index_one(std::vector<ast::Equation const*> const& trees, std::vector<NodeId>& residuals) {
  bool square = trees.size() == states_.size();
  std::vector<UnknownOrder> orders;
  for (auto const& [name, info] : states_) {
    square = square && (info.order > 0 || may_be_algebraic(name, info));
    orders.push_back({info.order, info.first});
  }
  if (!square) return enough_equations(trees, residuals);
  auto const reduced = reduce_index(model_.graph, residuals, orders);
  if (auto const* failure = std::get_if<IndexFailure>(&reduced)) {
    auto const index = static_cast<std::size_t>(failure->index);
    ast::Equation const& equation = *trees[static_cast<std::size_t>(failure->equation)];
    if (failure->kind == IndexFailure::Kind::input_rate)
      diagnostics_.add(errors::constraint_of_input(equation, model_.inputs[index].name));
    else if (failure->kind == IndexFailure::Kind::algebraic)
      diagnostics_.add(errors::constraint_of_unknown(equation, unknown_name(index)));
    else if (enough_equations(trees, residuals))
      diagnostics_.add(errors::surplus_equation(equation, state_names()));
    return false;
  }
  auto const& found = std::get<IndexOne>(reduced);
  residuals = found.residuals;
  for (Constraint const& constraint : found.constraints)
    constraints_.push_back({constraint.value, constraint_size(model_.graph, constraint.value),
                            trees[static_cast<std::size_t>(constraint.equation)]->span});
  return true;
}

bool ModelChecker::mentioned(std::string const& state) {
  bool found = false;
  NamesUsed uses(scope_, [&](ast::Reference const& reference) { found = found || reference.name.text == state; });
  each<ast::Equation>([&](ast::Equation const& equation) { uses.of(equation); });
  return found;
}

int ModelChecker::initial_primes(std::string const& state) {
  int most = -1;
  each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) {
    for (ast::InitialValue const& initial : declaration.values)
      if (initial.state.name.text == state) most = std::max(most, initial.state.primes);
  });
  return most;
}

Diagnostic ModelChecker::without_equation(std::string const& name, StateInfo const& info) {
  int const order = info.order > 0 ? info.order : initial_primes(name) + 1;
  std::string const highest = order > 0 ? fmt::format("`{}`", primed_name(name, order)) : fmt::format("`{0}'` or `{0}''`", name);
  return errors::state_without_equation(info.declaration->name.span, name, highest);
}

void ModelChecker::report_unmentioned_states() {
  for (auto const& [name, info] : states_)
    if (!mentioned(name)) diagnostics_.add(without_equation(name, info));
}

bool ModelChecker::enough_equations(std::vector<ast::Equation const*> const& trees, std::vector<NodeId> const& residuals) {
  std::size_t const n = states_.size();
  std::vector<std::vector<std::size_t>> unknowns(trees.size());
  for (std::size_t i = 0; i < trees.size(); ++i)
    for (std::size_t j = 0; j < n; ++j)
      if (model_.graph.depends(
              residuals[i],
              [&](Node const& node) { return is_leaf(node, LeafKind::unknown) && node.index == static_cast<int>(j); }) &&
          (states_[j].second.order > 0 || scope_.samples().discrete || may_be_algebraic(states_[j].first, states_[j].second)))
        unknowns[i].push_back(j);
  // A state whose derivative stands in an equation comes before one that an equation may be left for.
  for (auto& each : unknowns)
    std::stable_partition(each.begin(), each.end(), [&](std::size_t j) { return states_[j].second.order > 0; });
  // Kuhn's matching of equations to states, in the user's order, so that the surplus equation is the last one that finds no
  // place.
  std::vector<int> equation_of(n, -1);
  std::vector<std::size_t> surplus;
  for (std::size_t i = 0; i < trees.size(); ++i) {
    std::vector<bool> seen(n, false);
    auto const place = [&](auto const& self, std::size_t equation) -> bool {
      for (std::size_t const j : unknowns[equation]) {
        if (seen[j]) continue;
        seen[j] = true;
        if (equation_of[j] < 0 || self(self, static_cast<std::size_t>(equation_of[j]))) {
          equation_of[j] = static_cast<int>(equation);
          return true;
        }
      }
      return false;
    };
    if (!place(place, i)) surplus.push_back(i);
  }
  bool good = true;
  for (std::size_t j = 0; j < n; ++j) {
    if (equation_of[j] >= 0) continue;
    auto const& [name, info] = states_[j];
    bool const algebraic = !scope_.samples().discrete && mentioned(name) && info.order == 0 && initial_primes(name) < 1;
    diagnostics_.add(algebraic ? errors::algebraic_state(info.declaration->name.span, name) : without_equation(name, info));
    good = false;
  }
  if (good)
    for (std::size_t const i : surplus) {
      diagnostics_.add(errors::surplus_equation(*trees[i], state_names()));
      good = false;
    }
  return good;
}

NodeId ModelChecker::solved(NodeId node) {
  return model_.graph.substitute(node, [&](NodeId leaf) -> std::optional<NodeId> {
    Node const& what = model_.graph[leaf];
    if (what.leaf_kind != LeafKind::unknown || highest_.empty()) return std::nullopt;
    return highest_[static_cast<std::size_t>(what.index)];
  });
}

}  // namespace sysid
