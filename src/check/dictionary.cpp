// Declarations into a scope, terms written out and made nodes, equal ones merged, exclusions and units applied, targets taken
// apart.
#include "check/dictionary.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "check/dictionary_terms.hpp"
#include "check/errors.hpp"
#include "check/names_used.hpp"
#include "check/scope.hpp"
#include "check/units.hpp"
#include "expression/factors.hpp"
#include "regression/signals.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

bool same_dimension(std::optional<Unit> const& a, Unit const& b) { return a && a->dimension == b.dimension; }

/// A term on its way, before it is known in which equations it stands.
struct Candidate {
  WrittenTerm written;
  NodeId node = 0;
  std::optional<Unit> unit;
  Factors factors;
};

class DictionaryChecker {
 public:
  DictionaryChecker(ast::Dictionary const& tree, std::vector<ast::FunctionDefinition const*> const& functions,
                    Diagnostics& diagnostics)
      : tree_(tree),
        diagnostics_(diagnostics),
        before_(diagnostics.all().size()),
        scope_(out_.numbers.graph, diagnostics, functions),
        writer_(scope_, diagnostics) {
    for (ast::FunctionDefinition const* function : functions) out_.functions.push_back(*function);
  }

  std::optional<CheckedDictionary> run() {
    out_.name = tree_.name.text;
    out_.span = tree_.name.span;
    out_.tree = tree_;
    if (tree_.title) out_.title = tree_.title->value;
    declare();
    require_channels();
    find_orders();
    lay_out();
    definitions();
    values();
    targets();
    terms();
    if (failed()) return std::nullopt;
    exclude();
    equations();
    if (!failed()) coefficient_units_used();
    if (!failed()) parameters_used();
    if (!failed()) inputs_used();
    if (failed()) return std::nullopt;
    out_.measured.name = out_.name;
    out_.measured.graph = out_.numbers.graph;
    return std::move(out_);
  }

 private:
  struct StateInfo {
    std::optional<Unit> unit;
    Span span;
    int most_primes = 0;
    bool measured = false;
  };
  struct ParameterInfo {
    ast::DictionaryParameter const* tree = nullptr;
    std::optional<Unit> unit;
    std::optional<double> value;  // coherent SI
    bool used = false;
  };
  struct Target {
    ast::Expression const* tree;
    Typed value;
  };
  struct AllowedUnit {
    Unit unit;
    Span span;
    bool matched = false;
  };

  bool failed() const { return diagnostics_.has_errors(before_); }

  template <class Statement, class Visit>
  void each(Visit const& visit) const {
    for (ast::DictionaryStatement const& statement : tree_.statements)
      if (auto const* one = std::get_if<Statement>(&statement)) visit(*one);
  }
  template <class Visit>
  void each_item(ast::DictionaryListKind kind, Visit const& visit) const {
    each<ast::DictionaryList>([&](ast::DictionaryList const& list) {
      if (list.kind == kind)
        for (ast::Expression const& item : list.items) visit(item);
    });
  }

  // --- declarations
  void declare() {
    ast::TimeDeclaration const* first_time = nullptr;
    for (ast::DictionaryStatement const& statement : tree_.statements) {
      if (auto const* time = std::get_if<ast::TimeDeclaration>(&statement)) {
        if (first_time != nullptr) diagnostics_.add(errors::time_twice(time->span, first_time->span));
        if (std::exchange(first_time, time) != nullptr) continue;
        auto const unit = scope_.unit(time->time.unit);
        check_time_unit(unit, time->time.span, diagnostics_);
        scope_.declare(time->time.name, {TimeSymbol{}, unit, time->time.name.span});
      } else if (auto const* inputs = std::get_if<ast::InputDeclaration>(&statement)) {
        for (ast::Declared const& input : inputs->names) declare_input(input);
      } else if (auto const* states = std::get_if<ast::DictionaryStates>(&statement)) {
        for (ast::DictionaryState const& state : states->states) declare_state(state);
      } else if (auto const* parameter = std::get_if<ast::DictionaryParameter>(&statement)) {
        auto const unit = scope_.unit(parameter->name.unit);
        int const index = static_cast<int>(parameters_.size());
        if (scope_.declare(parameter->name.name, {ParameterSymbol{index}, unit, parameter->name.name.span}))
          parameters_.push_back({parameter, unit, {}});
      } else if (auto const* definition = std::get_if<ast::Definition>(&statement)) {
        scope_.declare(definition->name.name,
                       {DefinitionSymbol{definition}, scope_.unit(definition->name.unit), definition->name.name.span});
      } else if (auto const* function = std::get_if<ast::FunctionDefinition>(&statement)) {
        scope_.define_function(*function);
      } else if (auto const* units = std::get_if<ast::CoefficientUnits>(&statement)) {
        for (ast::UnitExpression const& unit : units->units)
          if (auto const known = check_unit(unit, diagnostics_)) allowed_.push_back({*known, unit.span});
      }
    }
  }

  void declare_input(ast::Declared const& input) {
    auto const unit = scope_.unit(input.unit);
    if (scope_.declare(input.name, {InputSymbol{static_cast<int>(out_.measured.inputs.size())}, unit, input.name.span}))
      out_.measured.inputs.push_back({input.name.text, unit, input.name.span});
  }

  void declare_state(ast::DictionaryState const& state) {
    auto const unit = scope_.unit(state.unit);
    if (state.primes == 0) {
      if (!scope_.declare(state.name, {StateSymbol{}, unit, state.name.span})) return;
      states_.emplace_back(state.name.text, StateInfo{unit, state.name.span});
    } else if (find_state(state.name.text) == nullptr) {
      diagnostics_.add(errors::derivative_of_nothing(state.name, state.primes));
      return;
    }
    if (!state.channel) {
      if (state.primes > 0) diagnostics_.add(errors::derivative_without_channel(state.name, state.primes));
      return;
    }
    StateInfo& info = *find_state(state.name.text);
    info.measured = true;
    info.most_primes = std::max(info.most_primes, state.primes);
    auto const [place, fresh] = bound_.emplace(state.channel->text, state.channel->span);
    if (!fresh) {
      diagnostics_.add(errors::channel_bound_twice(*state.channel, place->second));
      return;
    }
    // What a derivative is declared in, else what follows from the state.
    auto const rate = rate_unit(info.unit, state.primes);
    if (state.primes > 0 && unit && rate && unit->dimension != rate->dimension)
      diagnostics_.add(errors::unit_mismatch(state.span, "`" + primed_name(state.name.text, state.primes) + "`", unit->text,
                                             rate->text.empty() ? format_dimension(rate->dimension) : rate->text));
    Channel channel;
    channel.name = state.channel->text;
    channel.unit = unit && state.primes > 0 ? unit : rate;
    channel.span = state.channel->span;
    channel.noise.row = find_distribution("normal");  // it is not looked at
    out_.measured.channels.push_back(std::move(channel));
    out_.channel_spans.push_back(state.span);
    out_.numbers.channels.push_back({state.channel->text, index_of(state.name.text), state.primes, {}});
  }

  StateInfo* find_state(std::string const& name) {
    for (auto& [each, info] : states_)
      if (each == name) return &info;
    return nullptr;
  }
  int index_of(std::string const& name) const {
    return static_cast<int>(std::find_if(states_.begin(), states_.end(), [&](auto const& each) { return each.first == name; }) -
                            states_.begin());
  }

  void find_orders() {
    NamesUsed uses(scope_, [&](ast::Reference const& reference) {
      if (!reference.index.empty()) diagnostics_.add(errors::index_in_dictionary(reference));
      if (StateInfo* state = find_state(reference.name.text)) state->most_primes = std::max(state->most_primes, reference.primes);
      if (reference.primes > 0) primed_.insert(reference.name.text);
    });
    each<ast::DictionaryList>([&](ast::DictionaryList const& list) {
      for (ast::Expression const& item : list.items) uses.of(item);
    });
  }

  void require_channels() {
    for (auto const& [name, info] : states_)
      if (!info.measured) diagnostics_.add(errors::state_without_channel(info.span, name));
  }

  // Every derivative that is mentioned is a leaf of its own; none is solved for.
  void lay_out() {
    int first = 0;
    for (std::size_t i = 0; i < states_.size(); ++i) {
      auto& [name, info] = states_[i];
      scope_.find(name)->what = StateSymbol{first, info.most_primes + 1, static_cast<int>(i)};
      for (int k = 0; k <= info.most_primes; ++k)
        out_.numbers.symbols.push_back(
            {out_.numbers.graph.leaf(LeafKind::state, first + k), regression::Symbol::Kind::state, static_cast<int>(i), k});
      first += info.most_primes + 1;
      out_.numbers.states.push_back(name);
      out_.states.push_back({name, info.unit, info.span});
    }
    for (std::size_t i = 0; i < out_.measured.inputs.size(); ++i)
      for (int order = 0; order <= (primed_.contains(out_.measured.inputs[i].name) ? 1 : 0); ++order)
        out_.numbers.symbols.push_back(
            {out_.numbers.graph.leaf(order == 0 ? LeafKind::input : LeafKind::input_rate, static_cast<int>(i)),
             regression::Symbol::Kind::input, static_cast<int>(i), order});
    out_.numbers.symbols.push_back({out_.numbers.graph.leaf(LeafKind::time), regression::Symbol::Kind::time, 0, 0});
  }

  void definitions() {
    each<ast::Definition>([&](ast::Definition const& definition) {
      auto const value = scope_.definition(definition);
      if (value && definition.kind == ast::DefinitionKind::constant && !out_.numbers.graph.constant_value(value->node))
        diagnostics_.add(errors::constant_needed(definition.value.span, "the value of a constant"));
    });
  }

  void values() {
    for (ParameterInfo& parameter : parameters_) {
      if (!parameter.tree->value) {
        free_.insert(parameter.tree->name.name.text);
        continue;
      }
      std::string const& name = parameter.tree->name.name.text;
      auto const value = scope_.expression_in(parameter.unit, parameter.tree->name.name.span, *parameter.tree->value,
                                              {Occasion::Kind::declared, name});
      if (!value) continue;
      parameter.value = out_.numbers.graph.constant_value(adapt(out_.numbers.graph, *value, parameter.unit));
      if (!parameter.value) diagnostics_.add(errors::constant_needed(parameter.tree->value->span, "the value of a parameter"));
    }
  }

  NodeId with_values(NodeId root) {
    return out_.numbers.graph.substitute(root, [&](NodeId leaf) -> std::optional<NodeId> {
      Node const node = out_.numbers.graph[leaf];
      if (node.leaf_kind != LeafKind::parameter) return std::nullopt;
      auto const& value = parameters_[static_cast<std::size_t>(node.index)].value;
      return value ? std::optional(out_.numbers.graph.constant(*value)) : std::nullopt;
    });
  }

  // --- targets and terms
  void targets() {
    each_item(ast::DictionaryListKind::target, [&](ast::Expression const& tree) {
      auto const value = scope_.expression(tree);
      if (!value) return;
      for (Target const& before : targets_)
        if (before.value.node == value->node) {
          diagnostics_.add(errors::target_twice(tree.span, before.tree->span, unparse(tree)));
          return;
        }
      targets_.push_back({&tree, settled(*value)});
    });
    if (targets_.empty() && !failed()) diagnostics_.add(errors::no_target(tree_.name));
  }

  std::optional<Candidate> candidate(WrittenTerm written) {
    std::size_t const before = diagnostics_.all().size();
    auto value = scope_.expression(written.tree);
    if (!value || diagnostics_.has_errors(before)) return std::nullopt;
    *value = settled(*value);
    Candidate made;
    made.node = with_values(value->node);
    if (out_.numbers.graph.depends(made.node, [](Node const& node) { return is_parameter(node); })) {
      diagnostics_.add(errors::coefficient_inside(written.tree.span, unparse(written.tree)));
      return std::nullopt;
    }
    if (value->kind == Typed::Kind::known) made.unit = value->unit;
    if (value->kind == Typed::Kind::literal) made.unit = Unit{};
    made.factors = factors_of(out_.numbers.graph, made.node);
    made.written = std::move(written);
    return made;
  }

  static bool is_parameter(Node const& node) { return node.operation == Operation::leaf && node.leaf_kind == LeafKind::parameter; }

  void terms() {
    bool any = false;
    each_item(ast::DictionaryListKind::terms, [&](ast::Expression const& item) {
      any = true;
      for (WrittenTerm& written : writer_.write(item, free_)) {
        auto made = candidate(std::move(written));
        if (!made) return;  // the next of the same family has the same mistake
        if (made->factors.constant == 0) {
          out_.left_out.push_back({LeftOutTerm::Why::zero, made->written.text, {}});
          continue;
        }
        auto const same = std::find_if(terms_.begin(), terms_.end(), [&](Candidate const& each) { return is_same(each, *made); });
        if (same != terms_.end()) {
          out_.left_out.push_back({LeftOutTerm::Why::same, made->written.text, same->written.text});
        } else {
          terms_.push_back(std::move(*made));
        }
        if (terms_.size() > most_terms) {
          diagnostics_.add(errors::too_many_terms(item.span, most_terms));
          return;
        }
      }
    });
    if (!any) diagnostics_.add(errors::no_terms(tree_.name));
  }

  // One with a name before it and one without are told apart: the name asks for a unit.
  static bool is_same(Candidate const& a, Candidate const& b) {
    return a.factors.proportional(b.factors) && a.written.coefficient == b.written.coefficient;
  }

  void exclude() {
    each_item(ast::DictionaryListKind::exclude, [&](ast::Expression const& item) {
      bool any = false;
      for (WrittenTerm& written : writer_.write(item, {})) {
        auto const made = candidate(std::move(written));
        if (!made) return;
        auto const same = std::find_if(terms_.begin(), terms_.end(),
                                       [&](Candidate const& each) { return each.factors.proportional(made->factors); });
        if (same == terms_.end()) continue;
        any = true;
        out_.left_out.push_back({LeftOutTerm::Why::excluded, same->written.text, {}});
        terms_.erase(same);
      }
      if (any || failed()) return;
      errors::Names known;
      for (Candidate const& each : terms_) known.push_back(each.written.text);
      diagnostics_.add(errors::excludes_nothing(item.span, unparse(item), known));
    });
  }

  // --- equations
  void equations() {
    for (std::size_t e = 0; e < targets_.size(); ++e) equation(static_cast<int>(e));
  }

  void equation(int index) {
    Target const& target = targets_[static_cast<std::size_t>(index)];
    Graph& graph = out_.numbers.graph;
    DictionaryEquation equation;
    equation.text = unparse(*target.tree);
    equation.tree = *target.tree;
    if (target.value.kind == Typed::Kind::known) {
      equation.unit = target.value.unit;
      equation.unit->text = scope_.units().words(*equation.unit);
    }
    NodeId const root = with_values(target.value.node);
    std::vector<std::pair<std::string, NodeId>> coefficients;
    for (std::size_t p = 0; p < parameters_.size(); ++p) {
      NodeId const leaf = graph.leaf(LeafKind::parameter, static_cast<int>(p));
      if (!graph.depends(root, [&](Node const& node) { return is_parameter(node) && node.index == static_cast<int>(p); })) continue;
      std::string const& name = parameters_[p].tree->name.name.text;
      coefficients.emplace_back(name, leaf);
      if (std::exchange(parameters_[p].used, true)) {
        diagnostics_.add(errors::coefficient_of_two_targets(target.tree->span, name));
        return;
      }
    }
    auto const split = regression::split_target(graph, root, coefficients);
    if (!split) {
      diagnostics_.add(errors::target_not_linear(target.tree->span, equation.text, first_names(coefficients)));
      return;
    }
    regression::Equation numbers{equation.text, split->known, {}};
    for (regression::Term const& free : split->free) {
      ParameterInfo const& parameter = parameter_of(free.name);
      numbers.terms.push_back(free);
      equation.terms.push_back({free.name, tree_of(free.name, parameter.tree->name.name.span), free.name, true, parameter.unit,
                                parameter.tree->name.name.span});
    }
    std::vector<Candidate const*> kept(split->free.size());
    for (Candidate const& term : terms_) add(index, term, *split, equation, numbers, kept);
    if (equation.terms.size() == split->free.size() && !failed())
      diagnostics_.add(errors::nothing_left_of_terms(target.tree->span, equation.text));
    out_.equations.push_back(std::move(equation));
    out_.numbers.equations.push_back(std::move(numbers));
  }

  static errors::Names first_names(std::vector<std::pair<std::string, NodeId>> const& coefficients) {
    errors::Names names;
    for (auto const& [name, leaf] : coefficients) names.push_back(name);
    return names;
  }

  ParameterInfo const& parameter_of(std::string const& name) const {
    return *std::find_if(parameters_.begin(), parameters_.end(),
                         [&](ParameterInfo const& each) { return each.tree->name.name.text == name; });
  }

  static ast::Expression tree_of(std::string const& name, Span span) {
    return {{span}, ast::Reference{{span}, {{span}, name}, {}, 0}};
  }

  // The term in this equation, unless its unit or the target forbids it.
  void add(int index, Candidate const& term, regression::SplitTarget const& split, DictionaryEquation& equation,
           regression::Equation& numbers, std::vector<Candidate const*>& kept) {
    for (regression::Term const& free : split.free)
      if (factors_of(out_.numbers.graph, free.expression).proportional(term.factors)) {
        out_.left_out.push_back({LeftOutTerm::Why::same, term.written.text, "what `" + free.name + "` stands before", index});
        return;
      }
    std::optional<Unit> coefficient;
    if (equation.unit && term.unit) {
      coefficient = divide(*equation.unit, *term.unit);
      coefficient->scale = 1;  // as its words say
      coefficient->text = scope_.units().words(*coefficient);
    }
    if (!term.written.coefficient.empty()) {
      auto place = std::find_if(parameters_.begin(), parameters_.end(),
                                [&](ParameterInfo const& each) { return each.tree->name.name.text == term.written.coefficient; });
      if (coefficient && place->unit && coefficient->dimension != place->unit->dimension) {
        leave_out(index, term, *coefficient);
        return;
      }
      place->used = true;
      if (place->unit) coefficient = place->unit;
    }
    if (!allowed_.empty() && coefficient) {
      bool any = false;
      for (AllowedUnit& allowed : allowed_)
        if (same_dimension(coefficient, allowed.unit)) any = allowed.matched = true;
      if (!any) {
        leave_out(index, term, *coefficient);
        return;
      }
    }
    for (std::size_t j = split.free.size(); j < kept.size(); ++j) {
      if (!kept[j]->factors.proportional(term.factors)) continue;
      out_.left_out.push_back({LeftOutTerm::Why::same, term.written.text, kept[j]->written.text, index});
      if (!equation.terms[j].coefficient.empty()) return;
      equation.terms[j].coefficient = term.written.coefficient;  // a name that is given later stays with the term
      equation.terms[j].unit = coefficient;
      return;
    }
    kept.push_back(&term);
    equation.terms.push_back(
        {term.written.text, term.written.tree, term.written.coefficient, false, coefficient, term.written.tree.span});
    numbers.terms.push_back({term.written.text, term.node, false});
  }

  void leave_out(int index, Candidate const& term, Unit const& unit) {
    std::string const text = scope_.units().words(unit);
    out_.left_out.push_back({LeftOutTerm::Why::unit, term.written.text, text, index});
    possible_.insert(text);
  }

  // --- what was declared and matters nothing
  void coefficient_units_used() {
    for (DictionaryEquation const& equation : out_.equations)
      for (DictionaryTerm const& term : equation.terms)
        if (term.unit && !term.in_target) possible_.insert(scope_.units().words(*term.unit));
    errors::Names const possible(possible_.begin(), possible_.end());
    for (AllowedUnit const& allowed : allowed_)
      if (!allowed.matched) diagnostics_.add(errors::unit_of_no_term(allowed.span, allowed.unit.text, possible));
  }

  void parameters_used() {
    errors::Names const possible(possible_.begin(), possible_.end());
    for (ParameterInfo const& parameter : parameters_) {
      ast::Name const& name = parameter.tree->name.name;
      if (parameter.value || parameter.used) continue;  // one with a value may serve a definition
      bool const before_a_term =
          std::any_of(terms_.begin(), terms_.end(), [&](Candidate const& each) { return each.written.coefficient == name.text; });
      diagnostics_.add(before_a_term ? errors::unit_of_no_term(name.span, parameter.unit ? parameter.unit->text : "", possible)
                                     : errors::unused_parameter(name.span, name.text, false));
    }
  }

  void inputs_used() {
    std::vector<NodeId> roots;
    for (regression::Equation const& equation : out_.numbers.equations) {
      roots.push_back(equation.known);
      for (regression::Term const& term : equation.terms) roots.push_back(term.expression);
    }
    std::set<int> read;
    for (regression::Symbol const& symbol : regression::symbols_below(out_.numbers, roots))
      if (symbol.kind == regression::Symbol::Kind::input) read.insert(symbol.index);
    for (std::size_t i = 0; i < out_.measured.inputs.size(); ++i)
      if (!read.contains(static_cast<int>(i)))
        diagnostics_.add(errors::unused_input(out_.measured.inputs[i].span, out_.measured.inputs[i].name, "dictionary"));
  }

  static constexpr std::size_t most_terms = 1000;

  ast::Dictionary const& tree_;
  Diagnostics& diagnostics_;
  std::size_t before_;
  CheckedDictionary out_;
  Scope scope_;
  TermWriter writer_;
  std::vector<std::pair<std::string, StateInfo>> states_;
  std::vector<ParameterInfo> parameters_;
  std::set<std::string> free_;         // parameters that are looked for
  std::set<std::string> primed_;       // names that carry primes somewhere
  std::map<std::string, Span> bound_;  // channels
  std::vector<AllowedUnit> allowed_;
  std::vector<Target> targets_;
  std::vector<Candidate> terms_;
  std::set<std::string> possible_;  // units that coefficients would have
};

}  // namespace

std::optional<CheckedDictionary> check_dictionary(ast::Dictionary const& tree,
                                                  std::vector<ast::FunctionDefinition const*> const& functions,
                                                  Diagnostics& diagnostics) {
  return DictionaryChecker(tree, functions, diagnostics).run();
}

}  // namespace sysid
