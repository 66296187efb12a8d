// A model in passes: declare names, find the order of each state, write residuals, solve for the highest derivatives, then priors,
// channels and derived quantities, all in the first-order system's leaves.
#include "check/model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>

#include "check/determined.hpp"
#include "check/distributions.hpp"
#include "check/errors.hpp"
#include "check/scope.hpp"
#include "check/units.hpp"
#include "model/index_reduction.hpp"
#include "model/invariant.hpp"
#include "model/past.hpp"
#include "model/reduction.hpp"

namespace sysid {
namespace {

// Calls visit(reference) for every name in an expression and visit(call) for every call.
template <class Visit>
void each_use(ast::Expression const& tree, Visit const& visit) {
  std::visit(
      [&](auto const& node) {
        using Node = std::decay_t<decltype(node)>;
        if constexpr (std::is_same_v<Node, ast::Reference>) {
          visit(node);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Unary>>) {
          each_use(*node->operand, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Binary>>) {
          each_use(*node->left, visit);
          each_use(*node->right, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Call>>) {
          visit(*node);
          for (auto const& argument : node->arguments) each_use(argument.value, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::Conditional>>) {
          each_use(*node->condition, visit);
          each_use(*node->then, visit);
          each_use(*node->otherwise, visit);
        } else if constexpr (std::is_same_v<Node, ast::Box<ast::List>>) {
          for (auto const& item : node->items) each_use(item, visit);
        }
      },
      tree.node);
}

bool is_leaf(Node const& node, LeafKind kind) { return node.operation == Operation::leaf && node.leaf_kind == kind; }

// What an expression reads that it may not, in words; empty when it reads constants and parameters only.
std::string moving_part(Graph const& graph, NodeId root) {
  auto const reads = [&](LeafKind kind) { return graph.depends(root, [&](Node const& node) { return is_leaf(node, kind); }); };
  if (reads(LeafKind::state) || reads(LeafKind::unknown)) return "a state";
  if (reads(LeafKind::input) || reads(LeafKind::input_rate)) return "an input";
  if (reads(LeafKind::time)) return "time";
  if (reads(LeafKind::measured) || reads(LeafKind::previous)) return "samples";
  return {};
}

class ModelChecker {
 public:
  ModelChecker(ast::Model const& tree, std::vector<ast::FunctionDefinition const*> const& shared, Diagnostics& diagnostics)
      : tree_(tree), diagnostics_(diagnostics), before_(diagnostics.all().size()), scope_(model_.graph, diagnostics, shared) {}

  std::optional<Model> run() {
    model_.name = tree_.name.text;
    if (tree_.title) model_.title = tree_.title->value;
    declare();
    name_samples();
    if (!scope_.samples().discrete) find_orders();
    lay_out_states();
    scope_.samples().in_equation = true;
    equations();
    scope_.samples().in_equation = false;
    initial_values();
    parameters();
    channels();
    derived();
    if (!failed()) constraints();
    if (!failed()) finish_samples();
    if (!failed()) order_priors();
    if (failed()) return std::nullopt;
    model_.unchecked = scope_.unchecked();
    return std::move(model_);
  }

 private:
  struct StateInfo {
    ast::Declared const* declaration = nullptr;
    int order = 0;
    int first = 0;
    int equations = 0;  // in how many equations its highest derivative stands
  };

  bool failed() const { return diagnostics_.has_errors(before_); }

  template <class Statement, class Visit>
  void each(Visit const& visit) {
    for (ast::ModelStatement const& statement : tree_.statements)
      if (auto const* one = std::get_if<Statement>(&statement)) visit(*one);
  }

  void declare() {
    ast::TimeDeclaration const* first_time = nullptr;
    ast::DiscreteTimeDeclaration const* first_discrete = nullptr;
    for (ast::ModelStatement const& statement : tree_.statements) {
      if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement)) {
        if (first_time != nullptr) {
          diagnostics_.add(errors::time_twice(time->span, first_time->span));
          continue;
        }
        first_time = time;
        auto const unit = scope_.unit(time->time.unit);
        check_time_unit(unit, time->time.span, diagnostics_);
        scope_.declare(time->time.name, {TimeSymbol{}, unit, time->time.name.span});
      } else if (auto const* discrete = std::get_if<ast::DiscreteTimeDeclaration>(&statement)) {
        if (first_discrete != nullptr) diagnostics_.add(errors::time_twice(discrete->span, first_discrete->span));
        first_discrete = discrete;
        declare_step(*discrete);
      } else if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement)) {
        for (ast::Declared const& input : inputs->names) {
          auto const unit = scope_.unit(input.unit);
          if (scope_.declare(input.name, {InputSymbol{static_cast<int>(model_.inputs.size())}, unit, input.name.span}))
            model_.inputs.push_back({input.name.text, unit, input.name.span});
        }
      } else if (auto const* states = std::get_if<ast::StateDeclaration>(&statement)) {
        for (ast::Declared const& state : states->names)
          if (scope_.declare(state.name, {StateSymbol{}, scope_.unit(state.unit), state.name.span}))
            states_.push_back({state.name.text, StateInfo{&state}});
      } else if (auto const* parameter = std::get_if<ast::ParameterDeclaration>(&statement)) {
        auto const unit = scope_.unit(parameter->name.unit);
        int const index = static_cast<int>(model_.parameters.size());
        if (scope_.declare(parameter->name.name, {ParameterSymbol{index}, unit, parameter->name.name.span})) {
          Parameter declared;
          declared.name = parameter->name.name.text;
          declared.unit = unit;
          declared.span = parameter->name.name.span;
          declared.per_experiment = parameter->name.per_experiment;
          model_.parameters.push_back(std::move(declared));
          parameter_trees_.push_back(parameter);
        }
      } else if (auto const* definition = std::get_if<ast::Definition>(&statement)) {
        scope_.declare(definition->name.name,
                       {DefinitionSymbol{definition}, scope_.unit(definition->name.unit), definition->name.name.span});
      } else if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) {
        scope_.define_function(*function);
      }
    }
  }

  void declare_step(ast::DiscreteTimeDeclaration const& discrete) {
    model_.dynamics = Dynamics::discrete;
    scope_.samples().discrete = true;
    if (!discrete.step) return;
    Unit const second = unit_atom("s").value();
    auto const value = scope_.expression(*discrete.step);
    if (!value) return;
    if (value->kind == Typed::Kind::known && value->unit.dimension != second.dimension) {
      diagnostics_.add(errors::number_of_other_kind(discrete.step->span, "the time between samples", value->unit, second));
      return;
    }
    auto const step = model_.graph.constant_value(adapt(model_.graph, *value, second));
    if (!step || !(*step > 0))
      diagnostics_.add(errors::rate_not_positive(discrete.step->span));
    else
      model_.step = step;
  }

  void name_samples() {
    SampleNames& samples = scope_.samples();
    samples.states = static_cast<int>(states_.size());
    Diagnostics said_with_the_channel;
    each<ast::Observation>([&](ast::Observation const& observation) {
      samples.channels.emplace(observation.channel.name.text,
                               SampleNames::Channel{static_cast<int>(samples.channels.size()),
                                                    check_unit(observation.channel.unit, said_with_the_channel)});
    });
  }

  // Place holders of samples become what they stand for.
  void finish_samples() {
    Graph& graph = model_.graph;
    int const states = static_cast<int>(states_.size());
    std::vector<NodeId> predicted(model_.channels.size());
    enum class Mark { none, open, done };
    std::vector<Mark> marks(model_.channels.size(), Mark::none);
    bool good = true;
    auto const resolve = [&](auto const& self, NodeId root) -> NodeId {
      return graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
        Node const node = graph[leaf];
        if (node.leaf_kind != LeafKind::previous || node.lag != 0) return std::nullopt;
        auto const c = static_cast<std::size_t>(node.index - states);
        Channel const& channel = model_.channels[c];
        if (marks[c] == Mark::open && good) {
          diagnostics_.add(errors::prediction_cycle(channel.span, channel.name));
          good = false;
        }
        if (marks[c] == Mark::none) {
          marks[c] = Mark::open;
          predicted[c] = self(self, channel.noise.row->centre(graph, channel.noise.arguments));
          marks[c] = Mark::done;
        }
        return good ? std::optional(predicted[c]) : std::nullopt;
      });
    };
    for (NodeId const highest : highest_)
      for (NodeId const id : graph.reachable({&highest, 1})) {
        Node const& node = graph[id];
        if (!is_leaf(node, LeafKind::previous) || node.lag != 0 || !good) continue;
        Channel const& channel = model_.channels[static_cast<std::size_t>(node.index - states)];
        diagnostics_.add(errors::present_prediction(graph.span(id).value_or(channel.span), channel.name));
        good = false;
      }
    if (!good) return;
    for (std::size_t c = 0; c < model_.channels.size(); ++c) {
      Channel& channel = model_.channels[c];
      predicted[c] = resolve(resolve, graph.leaf(LeafKind::previous, states + static_cast<int>(c), Stage::begin, 0));
      for (NodeId& argument : channel.noise.arguments) argument = resolve(resolve, argument);
      bool const own = std::any_of(channel.noise.arguments.begin(), channel.noise.arguments.end(), [&](NodeId argument) {
        return graph.depends(argument, [&](Node const& node) {
          return is_leaf(node, LeafKind::measured) && node.index == static_cast<int>(c) && node.lag == 0;
        });
      });
      if (own && good) diagnostics_.add(errors::own_sample(channel.span, channel.name));
    }
    for (Derived& derived : model_.derived) derived.value = resolve(resolve, derived.value);
    if (failed()) return;
    model_.memories = scope_.samples().memories;
    for (NodeId& memory : model_.memories) memory = solved(memory);
    if (model_.dynamics == Dynamics::discrete)
      lay_out_lags(predicted);
    else if (model_.states.empty() && !reads_input_rate())
      model_.dynamics = Dynamics::none;
  }

  bool reads_input_rate() const {
    for (NodeId id = 0; id < model_.graph.size(); ++id)
      if (is_leaf(model_.graph[id], LeafKind::input_rate)) return true;
    return false;
  }

  void lay_out_lags(std::vector<NodeId> const& predicted) {
    std::vector<std::optional<NodeId>> initial = initial_pasts_;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      auto const& [name, info] = states_[i];
      auto const unit = scope_.find(name)->unit;
      model_.pasts.push_back({{name, unit, info.declaration->name.span}, highest_[i], -1, {}});
      model_.derived.push_back({{name, unit, info.declaration->name.span}, highest_[i], true});
    }
    for (std::size_t c = 0; c < model_.channels.size(); ++c) {
      Channel const& channel = model_.channels[c];
      model_.pasts.push_back({{channel.name, channel.unit, channel.span}, predicted[c], static_cast<int>(c), {}});
      initial.emplace_back();
    }
    if (auto const missing = lay_out_pasts(model_, initial)) {
      Past const& past = model_.pasts[static_cast<std::size_t>(*missing)];
      diagnostics_.add(errors::initial_past_missing(past.span, past.name));
    }
  }

  StateInfo* find_state(std::string const& name) {
    for (auto& [each, info] : states_)
      if (each == name) return &info;
    return nullptr;
  }
  std::size_t index_of(StateInfo const& info) const {
    return static_cast<std::size_t>(
        std::find_if(states_.begin(), states_.end(), [&](auto const& each) { return &each.second == &info; }) - states_.begin());
  }
  std::vector<std::string> state_names() const {
    std::vector<std::string> names;
    for (auto const& [name, info] : states_) names.push_back(name);
    return names;
  }

  // The names an equation uses, directly or through definitions and functions. Visits each definition and function once.
  class Uses {
   public:
    Uses(Scope const& scope, std::function<void(ast::Reference const&)> visit) : scope_(scope), visit_(std::move(visit)) {}
    void of(ast::Equation const& equation) {
      of(equation.left);
      of(equation.right);
    }
    void of(ast::Expression const& tree) { each_use(tree, *this); }
    void operator()(ast::Reference const& reference) const {
      visit_(reference);
      Symbol const* symbol = scope_.find(reference.name.text);
      auto const* definition = symbol == nullptr ? nullptr : std::get_if<DefinitionSymbol>(&symbol->what);
      if (definition != nullptr && seen_.insert(definition->definition).second) each_use(definition->definition->value, *this);
    }
    void operator()(ast::Call const& call) const {
      ast::FunctionDefinition const* function = scope_.find_function_definition(call.function.text);
      if (function != nullptr && seen_.insert(function).second) each_use(function->value, *this);
    }

   private:
    Scope const& scope_;
    std::function<void(ast::Reference const&)> visit_;
    mutable std::set<void const*> seen_;
  };

  // The order of a state is the most primes it carries in an equation or in what an equation uses.
  void find_orders() {
    Uses uses(scope_, [&](ast::Reference const& reference) {
      if (StateInfo* state = find_state(reference.name.text)) state->order = std::max(state->order, reference.primes);
    });
    each<ast::Equation>([&](ast::Equation const& equation) { uses.of(equation); });
  }

  void lay_out_states() {
    for (std::size_t i = 0; i < states_.size(); ++i) {
      auto& [name, info] = states_[i];
      Symbol* symbol = scope_.find(name);
      info.first = static_cast<int>(model_.states.size());
      symbol->what = StateSymbol{info.first, info.order, static_cast<int>(i)};
      for (int k = 0; k < info.order; ++k) {
        State component;
        component.name = primed_name(name, k);
        component.unit = rate_unit(symbol->unit, k);
        component.span = info.declaration->name.span;
        model_.states.push_back(std::move(component));
      }
    }
  }

  void equations() {
    std::vector<ast::Equation const*> trees;
    std::vector<NodeId> residuals;
    bool good = true;
    Graph& graph = model_.graph;
    each<ast::Equation>([&](ast::Equation const& equation) {
      auto const sides = scope_.equation(equation);
      if (!sides) {
        good = false;
        return;
      }
      orders_doubtful_ = orders_doubtful_ || sides->first.kind == Typed::Kind::wrong || sides->second.kind == Typed::Kind::wrong;
      trees.push_back(&equation);
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
    if (failure != nullptr)
      model_.implicit = Implicit{trees[static_cast<std::size_t>(failure->equation)]->span,
                                 unknown_name(static_cast<std::size_t>(failure->unknown))};
    else
      highest_ = std::get<std::vector<NodeId>>(solved);
    if (scope_.samples().discrete) return;  // they are the states at the present sample
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

  std::string unknown_name(std::size_t state) const { return primed_name(states_[state].first, states_[state].second.order); }

  // A state that is never differentiated is an algebraic unknown, where others are.
  bool may_be_algebraic(std::string const& name, StateInfo const& info) {
    return info.order == 0 && initial_primes(name) < 1 && mentioned(name) &&
           std::any_of(states_.begin(), states_.end(), [](auto const& each) { return each.second.order > 0; });
  }

  // As many equations as states, differentiated where they are constraints; said by name where that cannot be.
  bool reduce_to_index_one(std::vector<ast::Equation const*> const& trees, std::vector<NodeId>& residuals) {
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

  bool mentioned(std::string const& state) {
    bool found = false;
    Uses uses(scope_, [&](ast::Reference const& reference) { found = found || reference.name.text == state; });
    each<ast::Equation>([&](ast::Equation const& equation) { uses.of(equation); });
    return found;
  }

  // The most primes of a state in `initial`; -1 without any.
  int initial_primes(std::string const& state) {
    int most = -1;
    each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) {
      for (ast::InitialValue const& initial : declaration.values)
        if (initial.state.name.text == state) most = std::max(most, initial.state.primes);
    });
    return most;
  }

  // Names the derivative to write an equation for: the initial values tell the order that the user has in mind.
  Diagnostic without_equation(std::string const& name, StateInfo const& info) {
    int const order = info.order > 0 ? info.order : initial_primes(name) + 1;
    std::string const highest = order > 0 ? fmt::format("`{}`", primed_name(name, order)) : fmt::format("`{0}'` or `{0}''`", name);
    return errors::state_without_equation(info.declaration->name.span, name, highest);
  }

  // Where an equation could not be understood, only a state that stands in none is surely left without one.
  void report_unmentioned_states() {
    for (auto const& [name, info] : states_)
      if (!mentioned(name)) diagnostics_.add(without_equation(name, info));
  }

  // As many equations as states, each state with one that contains its highest derivative: said by name where it is not so.
  bool enough_equations(std::vector<ast::Equation const*> const& trees, std::vector<NodeId> const& residuals) {
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

  // In channels and derived quantities a highest derivative (an acceleration) stands for its solution.
  NodeId solved(NodeId node) {
    return model_.graph.substitute(node, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const& what = model_.graph[leaf];
      if (what.leaf_kind != LeafKind::unknown || highest_.empty()) return std::nullopt;
      return highest_[static_cast<std::size_t>(what.index)];
    });
  }

  // In discrete time one value stands for all samples before the first; it may be what a channel measured there.
  void initial_pasts() {
    initial_pasts_.resize(states_.size());
    std::map<std::string, Span> given;
    each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) {
      for (ast::InitialValue const& initial : declaration.values) {
        auto const place =
            std::find_if(states_.begin(), states_.end(), [&](auto const& state) { return state.first == initial.state.name.text; });
        if (place == states_.end()) {
          diagnostics_.add(errors::not_a_state(initial.state.name, state_names()));
          continue;
        }
        if (initial.state.primes > 0) {
          diagnostics_.add(errors::primes_in_discrete_time(initial.state));
          continue;
        }
        if (auto const [first, fresh] = given.emplace(place->first, initial.span); !fresh) {
          diagnostics_.add(errors::initial_twice(initial.span, first->second, place->first));
          continue;
        }
        auto const value = scope_.expression(initial.value);
        if (!value) continue;
        bool const moves = model_.graph.depends(value->node, [](Node const& node) {
          return node.operation == Operation::leaf && node.leaf_kind != LeafKind::parameter &&
                 !(node.leaf_kind == LeafKind::measured && node.lag == 0);
        });
        if (moves) {
          diagnostics_.add(errors::initial_moves(initial.value.span));
          continue;
        }
        initial_pasts_[static_cast<std::size_t>(place - states_.begin())] =
            adapt(model_.graph, *value, scope_.find(place->first)->unit);
      }
    });
  }

  void initial_values() {
    if (scope_.samples().discrete) {
      initial_pasts();
      return;
    }
    std::map<int, Span> given;
    each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) {
      for (ast::InitialValue const& initial : declaration.values) {
        StateInfo const* info = find_state(initial.state.name.text);
        if (info == nullptr) {
          diagnostics_.add(errors::not_a_state(initial.state.name, state_names()));
          continue;
        }
        if (info->order == 0 && model_.unknowns.empty()) continue;  // reported with the equations
        if (initial.state.primes == info->order && (info->order == 0 || model_.implicit)) {
          guess(initial, model_.unknowns[index_of(*info)]);
          continue;
        }
        if (initial.state.primes >= info->order) {
          if (!orders_doubtful_) diagnostics_.add(errors::initial_of_highest(initial.state, initial.state.name.text, info->order));
          continue;
        }
        int const component = info->first + initial.state.primes;
        State& state = model_.states[static_cast<std::size_t>(component)];
        if (auto const [place, fresh] = given.emplace(component, initial.span); !fresh) {
          diagnostics_.add(errors::initial_twice(initial.span, place->second, state.name));
          continue;
        }
        auto const value = scope_.expression_in(state.unit, state.span, initial.value, {Occasion::Kind::declared, state.name});
        if (!value) continue;
        if (!moving_part(model_.graph, value->node).empty()) {
          diagnostics_.add(errors::initial_moves(initial.value.span));
          continue;
        }
        state.initial = adapt(model_.graph, *value, state.unit);
        state.initial_given = true;
      }
    });
    for (std::size_t i = 0; i < model_.states.size() && !orders_doubtful_;) {
      Span const declaration = model_.states[i].span;
      std::vector<std::string> missing;
      for (; i < model_.states.size() && model_.states[i].span == declaration; ++i)
        if (!given.contains(static_cast<int>(i))) missing.push_back(model_.states[i].name);
      if (!missing.empty()) diagnostics_.add(errors::initial_missing(declaration, missing));
    }
  }

  // Where the search for an unknown's first value begins.
  void guess(ast::InitialValue const& initial, Unknown& unknown) {
    auto const value = scope_.expression(initial.value);
    if (!value) return;
    if (moving_part(model_.graph, value->node).empty())
      unknown.guess = adapt(model_.graph, *value, unknown.unit);
    else
      diagnostics_.add(errors::initial_moves(initial.value.span));
  }

  // Equations that were differentiated must hold at the start.
  void constraints() {
    std::optional<Span> given;
    each<ast::InitialDeclaration>([&](ast::InitialDeclaration const& declaration) { given = given.value_or(declaration.span); });
    std::vector<NodeId> initial;
    for (State const& state : model_.states) initial.push_back(state.initial);
    std::set<std::size_t> seen;
    for (Invariant const& constraint : constraints_) {
      bool const original = seen.insert(constraint.span.begin).second;
      if (original) model_.invariants.push_back(constraint);
      if (given && violated_at_start(model_, constraint, initial)) {
        diagnostics_.add(errors::start_off_constraint(constraint.span, *given));
        return;
      }
    }
  }

  void parameters() {
    for (std::size_t i = 0; i < model_.parameters.size(); ++i) {
      ast::ParameterDeclaration const& tree = *parameter_trees_[i];
      Parameter& parameter = model_.parameters[i];
      if (tree.value) {
        auto const value =
            scope_.expression_in(parameter.unit, parameter.span, *tree.value, {Occasion::Kind::declared, parameter.name});
        if (!value) continue;
        NodeId const node = adapt(model_.graph, *value, parameter.unit);
        if (!model_.graph.constant_value(node)) {
          diagnostics_.add(errors::constant_needed(tree.value->span, "the value of a parameter"));
          continue;
        }
        parameter.value = node;
      } else if (tree.prior) {
        auto use = check_distribution(scope_, *tree.prior, parameter);
        if (!use) continue;
        if (use->row->discrete) {
          diagnostics_.add(errors::count_as_prior(*tree.prior));
          continue;
        }
        std::vector<NodeId> parts = use->arguments;
        if (use->lower) parts.push_back(*use->lower);
        if (use->upper) parts.push_back(*use->upper);
        bool good = true;
        for (NodeId const part : parts)
          if (std::string const what = moving_part(model_.graph, part); !what.empty() && good) {
            diagnostics_.add(errors::prior_reads(tree.prior->span, parameter.name, what));
            good = false;
          }
        for (NodeId const part : parts)
          for (NodeId const node : model_.graph.reachable({&part, 1}))
            if (good && !parameter.per_experiment && is_leaf(model_.graph[node], LeafKind::parameter) &&
                model_.parameters[static_cast<std::size_t>(model_.graph[node].index)].per_experiment) {
              diagnostics_.add(errors::shared_prior_reads_own(
                  tree.prior->span, parameter.name, model_.parameters[static_cast<std::size_t>(model_.graph[node].index)].name));
              good = false;
            }
        if (good) parameter.prior = std::move(use);
      } else if (!parameter.per_experiment) {  // else every data block says what it is
        diagnostics_.add(errors::no_prior_or_value(tree));
      }
    }
  }

  // Each sampled parameter after those its prior refers to.
  void order_priors() {
    enum class Mark { none, open, done };
    std::vector<Mark> marks(model_.parameters.size(), Mark::none);
    std::vector<std::string> path;
    auto const visit = [&](auto const& self, int index) -> bool {
      Parameter const& parameter = model_.parameters[static_cast<std::size_t>(index)];
      if (marks[static_cast<std::size_t>(index)] == Mark::done || !parameter.prior) return true;
      path.push_back(parameter.name);
      if (marks[static_cast<std::size_t>(index)] == Mark::open) {
        auto const begin = std::find(path.begin(), path.end(), parameter.name);
        diagnostics_.add(errors::prior_cycle(parameter.span, std::vector<std::string>(begin, path.end())));
        return false;
      }
      marks[static_cast<std::size_t>(index)] = Mark::open;
      std::vector<NodeId> roots = parameter.prior->arguments;
      if (parameter.prior->lower) roots.push_back(*parameter.prior->lower);
      if (parameter.prior->upper) roots.push_back(*parameter.prior->upper);
      for (NodeId const node : model_.graph.reachable(roots))
        if (is_leaf(model_.graph[node], LeafKind::parameter) && !self(self, model_.graph[node].index)) return false;
      marks[static_cast<std::size_t>(index)] = Mark::done;
      path.pop_back();
      model_.sampling_order.push_back(index);
      return true;
    };
    for (std::size_t i = 0; i < model_.parameters.size(); ++i)
      if (!visit(visit, static_cast<int>(i))) return;
  }

  void channels() {
    std::map<std::string, Span> seen;
    each<ast::Observation>([&](ast::Observation const& observation) {
      ast::Name const& name = observation.channel.name;
      if (auto const [place, fresh] = seen.emplace(name.text, name.span); !fresh) {
        diagnostics_.add(errors::channel_twice(name, place->second));
        return;
      }
      Channel channel;
      channel.name = name.text;
      channel.span = name.span;
      channel.unit = scope_.unit(observation.channel.unit);
      Quantity variate = channel;
      if (!channel.unit) {
        channel.unit = variate.unit = location_unit(observation.noise);
        if (channel.unit) variate.span = location_argument(observation.noise)->span;
      }
      auto use = check_distribution(scope_, observation.noise, variate);
      if (!use) return;
      if (!use->row->noise) {
        std::vector<std::string> known;
        for (DistributionRow const& row : distributions())
          if (row.noise) known.emplace_back(row.name);
        diagnostics_.add(errors::not_a_noise(observation.noise, known));
        return;
      }
      if (use->lower || use->upper) {
        diagnostics_.add(errors::truncated_noise(observation.noise));
        return;
      }
      for (NodeId& argument : use->arguments) argument = solved(argument);
      channel.noise = std::move(*use);
      model_.channels.push_back(std::move(channel));
    });
  }

  // The unit of what the noise is centred on, when it is known; a failing expression is reported by the caller's second look.
  std::optional<Unit> location_unit(ast::Call const& noise) {
    ast::Expression const* location = location_argument(noise);
    if (location == nullptr) return std::nullopt;
    Diagnostics ignored;
    Scope quiet = scope_.with(ignored);
    auto const value = quiet.expression(*location);
    if (!value || value->kind != Typed::Kind::known) return std::nullopt;
    return settled(*value).unit;
  }

  void derived() {
    each<ast::Definition>([&](ast::Definition const& definition) {
      auto const value = scope_.definition(definition);  // every definition is looked at, used or not
      if (!value || definition.kind == ast::DefinitionKind::local) return;
      std::string const moving = moving_part(model_.graph, value->node);
      if (definition.kind == ast::DefinitionKind::constant) {
        if (!model_.graph.constant_value(value->node))
          diagnostics_.add(errors::constant_needed(definition.value.span, "the value of a constant"));
        return;
      }
      Derived quantity;
      quantity.name = definition.name.name.text;
      quantity.unit = value->kind == Typed::Kind::known ? std::optional(value->unit) : std::nullopt;
      quantity.span = definition.name.name.span;
      quantity.value = solved(value->node);
      quantity.per_sample = !moving.empty();
      model_.derived.push_back(std::move(quantity));
    });
    // Algebraic unknowns are shown like states.
    for (std::size_t i = 0; i < model_.unknowns.size(); ++i) {
      if (model_.unknowns[i].component >= 0) continue;
      Derived quantity;
      static_cast<Quantity&>(quantity) = model_.unknowns[i];
      quantity.value = solved(model_.graph.leaf(LeafKind::unknown, static_cast<int>(i)));
      quantity.per_sample = !moving_part(model_.graph, quantity.value).empty();
      model_.derived.push_back(std::move(quantity));
    }
  }

  ast::Model const& tree_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  Model model_;
  Scope scope_;
  std::vector<std::pair<std::string, StateInfo>> states_;
  std::vector<ast::ParameterDeclaration const*> parameter_trees_;
  std::vector<NodeId> highest_;                       // solutions for the unknowns; none for an implicit model
  std::vector<Invariant> constraints_;                // of every differentiation
  bool orders_doubtful_ = false;                      // after a mistake in the units of an equation: a prime may be missing there
  std::vector<std::optional<NodeId>> initial_pasts_;  // of each state of a discrete-time model
};

}  // namespace

std::optional<Model> check_model(ast::Model const& tree, std::vector<ast::FunctionDefinition const*> const& shared,
                                 Diagnostics& diagnostics) {
  return ModelChecker(tree, shared, diagnostics).run();
}

}  // namespace sysid
