// A model in passes: declare names, find the order of each state, write residuals, solve for the highest derivatives, then priors,
// channels and derived quantities, all in the first-order system's leaves.
#include "check/model.hpp"

#include "check/model_checker.hpp"

namespace sysid {

bool is_leaf(Node const& node, LeafKind kind) { return node.operation == Operation::leaf && node.leaf_kind == kind; }

std::string moving_part(Graph const& graph, NodeId root) {
  auto const reads = [&](LeafKind kind) { return graph.depends(root, [&](Node const& node) { return is_leaf(node, kind); }); };
  if (reads(LeafKind::state) || reads(LeafKind::unknown)) return "a state";
  if (reads(LeafKind::input) || reads(LeafKind::input_rate)) return "an input";
  if (reads(LeafKind::time)) return "time";
  if (reads(LeafKind::process)) return "a Gaussian process";
  if (reads(LeafKind::measured) || reads(LeafKind::previous)) return "samples";
  return {};
}

ModelChecker::ModelChecker(ast::Model const& tree, std::vector<ast::FunctionDefinition const*> const& shared,
                           Diagnostics& diagnostics)
    : tree_(tree), diagnostics_(diagnostics), before_(diagnostics.all().size()), scope_(model_.graph, diagnostics, shared) {}

std::optional<Model> ModelChecker::run() {
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
  if (!failed()) processes();
  if (!failed()) finish_samples();
  if (!failed()) order_priors();
  if (!failed()) positive_widths();
  if (failed()) return std::nullopt;
  model_.unchecked = scope_.unchecked();
  return std::move(model_);
}

std::optional<Model> check_model(ast::Model const& tree, std::vector<ast::FunctionDefinition const*> const& shared,
                                 Diagnostics& diagnostics) {
  return ModelChecker(tree, shared, diagnostics).run();
}

}  // namespace sysid
