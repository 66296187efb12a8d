// An equation of each target: what it brings itself, then the terms whose coefficients have a unit that is allowed.
#include <algorithm>

#include "check/dictionary/dictionary_checker.hpp"
#include "check/message/errors.hpp"
#include "syntax/unparse.hpp"

namespace sysid {
namespace {

bool same_dimension(std::optional<Unit> const& a, Unit const& b) { return a && a->dimension == b.dimension; }

errors::Names names_of(std::vector<std::pair<std::string, NodeId>> const& coefficients) {
  errors::Names names;
  for (auto const& [name, leaf] : coefficients) names.push_back(name);
  return names;
}

ast::Expression tree_of(std::string const& name, Span span) { return {{span}, ast::Reference{{span}, {{span}, name}, {}, 0}}; }

}  // namespace

void DictionaryChecker::equations() {
  for (std::size_t e = 0; e < targets_.size(); ++e) equation(static_cast<int>(e));
}

void DictionaryChecker::equation(int index) {
  Target const& target = targets_[static_cast<std::size_t>(index)];
  Graph& graph = out_.numbers.graph;
  DictionaryEquation equation;
  equation.text = unparse(*target.tree);
  equation.tree = *target.tree;
  if (target.value.kind == Typed::Kind::known) {
    equation.unit = target.value.unit;
    if (equation.unit->text.empty()) {
      equation.unit->scale = 1;  // as its words say: of `m*y''`, y in mm, it would be a thousandth
      equation.unit->text = scope_.units().words(*equation.unit);
    }
  }
  NodeId const root = with_values(target.value.node);
  std::vector<std::pair<std::string, NodeId>> coefficients;
  for (std::size_t p = 0; p < parameters_.size(); ++p) {
    NodeId const leaf = graph.leaf(LeafKind::parameter, static_cast<int>(p));
    if (!graph.depends(root, [&](Node const& node) { return is_parameter(node) && node.index == static_cast<int>(p); })) continue;
    std::string const& name = parameters_[p].tree->name.name.text;
    if (parameters_[p].inner) {
      diagnostics_.add(errors::inner_in_target(target.tree->span, equation.text, name, declared_text(parameters_[p])));
      return;
    }
    coefficients.emplace_back(name, leaf);
    if (std::exchange(parameters_[p].used, true)) {
      diagnostics_.add(errors::coefficient_of_two_targets(target.tree->span, name));
      return;
    }
  }
  auto const split = regression::split_target(graph, root, coefficients);
  if (!split) {
    diagnostics_.add(errors::target_not_linear(target.tree->span, equation.text, names_of(coefficients)));
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

DictionaryChecker::ParameterInfo& DictionaryChecker::parameter_of(std::string const& name) {
  return *std::find_if(parameters_.begin(), parameters_.end(),
                       [&](ParameterInfo const& each) { return each.tree->name.name.text == name; });
}

void DictionaryChecker::add(int index, Candidate const& term, regression::SplitTarget const& split, DictionaryEquation& equation,
                            regression::Equation& numbers, std::vector<Candidate const*>& kept) {
  for (regression::Term const& free : split.free)
    if (factors_of(out_.numbers.graph, free.expression).proportional(term.factors)) {
      out_.excluded.push_back({ExcludedTerm::Why::same, term.written.text, "the term of `" + free.name + "` in the target", index});
      return;
    }
  std::optional<Unit> coefficient;
  if (equation.unit && term.unit) {
    coefficient = divide(*equation.unit, *term.unit);
    if (coefficient->text.empty()) {  // of a term without a unit it is that of the target, as written
      coefficient->scale = 1;         // as its words say
      coefficient->text = scope_.units().words(*coefficient);
    }
  }
  if (!term.written.coefficient.empty()) {
    ParameterInfo& named = parameter_of(term.written.coefficient);
    if (coefficient && named.unit && coefficient->dimension != named.unit->dimension) {
      leave_out(index, term, *coefficient);
      return;
    }
    named.used = true;
    if (named.unit) coefficient = named.unit;
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
  if (is_target(index, term, split)) return;
  for (std::size_t j = split.free.size(); j < kept.size(); ++j) {
    if (!kept[j]->factors.proportional(term.factors)) continue;
    out_.excluded.push_back({ExcludedTerm::Why::same, term.written.text, kept[j]->written.text, index});
    if (!equation.terms[j].coefficient.empty()) return;
    equation.terms[j].coefficient = term.written.coefficient;  // a name that is given later stays with the term
    equation.terms[j].unit = coefficient;
    return;
  }
  for (InnerParameter const& each : out_.inner)
    if (depends_on(term.node, each.leaf)) parameter_of(each.quantity.name).used = true;
  kept.push_back(&term);
  equation.terms.push_back(
      {term.written.text, term.written.tree, term.written.coefficient, false, coefficient, term.written.tree.span});
  numbers.terms.push_back({term.written.text, term.node, false});
}

bool DictionaryChecker::is_target(int index, Candidate const& term, regression::SplitTarget const& split) {
  if (!split.free.empty() || out_.numbers.discrete || term.factors.powers.empty() ||
      !term.factors.proportional(factors_of(out_.numbers.graph, split.known)))
    return false;
  ast::Expression const& target = *targets_[static_cast<std::size_t>(index)].tree;
  std::string const text = unparse(target);
  auto const* name = std::get_if<ast::Reference>(&target.node);
  bool const rate = name != nullptr && name->primes == 0 && find_state(name->name.text) != nullptr;
  if (rate || targets_.size() == 1)
    diagnostics_.add(
        errors::target_among_terms(target.span, term.written.tree.span, text, term.written.text, rate ? text + "'" : ""));
  else  // in the other equations it may stand
    out_.excluded.push_back({ExcludedTerm::Why::same, term.written.text, "the target", index});
  return true;
}

void DictionaryChecker::close_terms() {
  if (out_.inner.empty()) return;
  std::vector<double> medians;
  for (InnerParameter const& each : out_.inner) {
    constexpr int draws = 101;
    medians.push_back(sorted_draws(each, draws)[draws / 2]);
  }
  for (regression::Equation const& equation : out_.numbers.equations) {
    out_.open.emplace_back();
    for (regression::Term const& term : equation.terms) out_.open.back().push_back(term.expression);
  }
  out_.numbers = with_inner(std::move(out_.numbers), out_.open, out_.inner, medians);
}

void DictionaryChecker::leave_out(int index, Candidate const& term, Unit const& unit) {
  std::string const text = scope_.units().words(unit);
  out_.excluded.push_back({ExcludedTerm::Why::unit, term.written.text, text, index});
  possible_.insert(text);
}

}  // namespace sysid
