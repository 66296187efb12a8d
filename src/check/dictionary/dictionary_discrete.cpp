// Difference equations: what a target and its terms may read of the present sample.
#include <algorithm>

#include "check/dictionary/dictionary_checker.hpp"
#include "check/message/errors.hpp"

namespace sysid {

void DictionaryChecker::require_difference_equations() {
  Graph const& graph = out_.numbers.graph;
  auto const present = [](int state) {
    return [state](Node const& node) {
      return node.operation == Operation::leaf && node.leaf_kind == LeafKind::unknown && node.index == state;
    };
  };
  std::vector<char> has_equation(states_.size(), 0);
  for (std::size_t e = 0; e < out_.numbers.equations.size(); ++e) {
    regression::Equation const& equation = out_.numbers.equations[e];
    Node const& target = graph[equation.known];
    DictionaryEquation const& written = out_.equations[e];
    if (target.operation != Operation::leaf || target.leaf_kind != LeafKind::unknown) {
      diagnostics_.add(errors::target_of_discrete_time(written.tree.span, written.text, states_.front().first));
      continue;
    }
    has_equation[static_cast<std::size_t>(target.index)] = 1;
    for (std::size_t j = 0; j < equation.terms.size(); ++j) {
      if (!graph.depends(equation.terms[j].expression, present(target.index))) continue;
      diagnostics_.add(errors::present_in_term(written.terms[j].span, written.terms[j].text,
                                               states_[static_cast<std::size_t>(target.index)].first));
      break;  // the next of the same family has the same mistake
    }
  }
  if (failed()) return;
  for (std::size_t i = 0; i < states_.size(); ++i)
    if (has_equation[i] == 0) diagnostics_.add(errors::state_without_target(states_[i].second.span, states_[i].first));
}

}  // namespace sysid
