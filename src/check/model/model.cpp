// A model in passes: declare names, find the order of each state, write residuals, solve for the highest derivatives, then priors,
// channels and derived quantities, all in the first-order system's leaves.
#include "check/model/model.hpp"

#include "check/model/model_checker.hpp"

namespace sysid {

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
  infer_disturbance_units();
  lay_out_disturbances();
  scope_.samples().in_equation = true;
  equations();
  scope_.samples().in_equation = false;
  initial_values();
  disturbances();
  parameters();
  channels();
  derived();
  if (!failed()) constraints();
  if (!failed()) processes();
  if (!failed()) finish_samples();
  if (!failed()) place_disturbances();
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
