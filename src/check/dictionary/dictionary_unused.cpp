// Declarations of a dictionary that have no effect: units of coefficients, parameters, inputs.
#include <algorithm>

#include "check/dictionary/dictionary_checker.hpp"
#include "check/message/errors.hpp"

namespace sysid {

void DictionaryChecker::coefficient_units_used() {
  for (DictionaryEquation const& equation : out_.equations)
    for (DictionaryTerm const& term : equation.terms)
      if (term.unit && !term.in_target) possible_.insert(scope_.units().words(*term.unit));
  errors::Names const possible(possible_.begin(), possible_.end());
  for (AllowedUnit const& allowed : allowed_)
    if (!allowed.matched) diagnostics_.add(errors::unit_of_no_term(allowed.span, allowed.unit.text, possible));
}

void DictionaryChecker::parameters_used() {
  errors::Names const possible(possible_.begin(), possible_.end());
  for (ParameterInfo const& parameter : parameters_) {
    ast::Name const& name = parameter.tree->name.name;
    if (parameter.value || parameter.used) continue;  // one with a value may serve a definition
    bool const before_a_term =
        std::any_of(terms_.begin(), terms_.end(), [&](Candidate const& each) { return each.written.coefficient == name.text; });
    diagnostics_.add(before_a_term ? errors::unit_of_no_term(name.span, parameter.unit ? parameter.unit->text : "", possible)
                                   : errors::unused_parameter(name.span, name.text, false, errors::Declarer::dictionary));
  }
}

void DictionaryChecker::inputs_used() {
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
      diagnostics_.add(
          errors::unused_input(out_.measured.inputs[i].span, out_.measured.inputs[i].name, errors::Declarer::dictionary));
}

}  // namespace sysid
