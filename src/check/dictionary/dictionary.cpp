// A dictionary in passes: declare names, find which derivatives stand somewhere, give parameters their values, read targets and
// terms, put each term into the equations whose units allow it.
#include "check/dictionary/dictionary.hpp"

#include "check/dictionary/dictionary_checker.hpp"

namespace sysid {

DictionaryChecker::DictionaryChecker(ast::Dictionary const& tree, std::vector<ast::FunctionDefinition const*> const& functions,
                                     Diagnostics& diagnostics)
    : tree_(tree),
      diagnostics_(diagnostics),
      before_(diagnostics.all().size()),
      scope_(out_.numbers.graph, diagnostics, functions),
      writer_(scope_, diagnostics) {
  for (ast::FunctionDefinition const* function : functions) out_.functions.push_back(*function);
}

std::optional<CheckedDictionary> DictionaryChecker::run() {
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
  if (!failed() && out_.numbers.discrete) require_difference_equations();
  if (!failed()) lay_out_lags();
  if (!failed()) coefficient_units_used();
  if (!failed()) parameters_used();
  if (!failed()) inputs_used();
  if (!failed()) close_terms();
  if (failed()) return std::nullopt;
  out_.measured.name = out_.name;
  out_.measured.graph = out_.numbers.graph;
  return std::move(out_);
}

std::optional<CheckedDictionary> check_dictionary(ast::Dictionary const& tree,
                                                  std::vector<ast::FunctionDefinition const*> const& functions,
                                                  Diagnostics& diagnostics) {
  return DictionaryChecker(tree, functions, diagnostics).run();
}

}  // namespace sysid
