// Priors, channels and derived quantities, in the leaves of the first-order system.
#include "check/model/model_checker.hpp"

#include <algorithm>
#include <cmath>

#include "check/expression/distributions.hpp"
#include "check/message/errors.hpp"
#include "check/message/errors_numbers.hpp"

namespace sysid {

void ModelChecker::parameters() {
  for (std::size_t i = 0; i < parameter_trees_.size(); ++i) {  // coefficients of expansions follow
    ast::ParameterDeclaration const& tree = *parameter_trees_[i];
    Parameter& parameter = model_.parameters[i];
    if (tree.value) {
      auto const value =
          scope_.expression_in(parameter.unit, parameter.span, *tree.value, {Occasion::Kind::declared, parameter.name});
      if (!value) continue;
      NodeId const node = adapt(model_.graph, *value, parameter.unit);
      auto const number = model_.graph.constant_value(node);
      if (!number || !std::isfinite(*number)) {
        errors::Subject const what{"the value of a parameter"};
        diagnostics_.add(number ? errors::value_not_finite(tree.value->span, what)
                                : errors::constant_needed(tree.value->span, what));
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

void ModelChecker::order_priors() {
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

void ModelChecker::channels() {
  std::map<std::string, Span> seen;
  Diagnostics ignored;
  std::optional<Scope> quiet;  // one for all channels: it is a copy of all names
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
      if (!quiet) quiet.emplace(scope_.with(ignored));
      channel.unit = variate.unit = location_unit(observation.noise, *quiet);
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

std::optional<Unit> ModelChecker::location_unit(ast::Call const& noise, Scope& quiet) {
  ast::Expression const* location = location_argument(noise);
  if (location == nullptr) return std::nullopt;
  auto const value = quiet.expression(*location);
  if (!value || value->kind != Typed::Kind::known) return std::nullopt;
  Unit unit = with_own_unit(*value).unit;
  // A product has no unit that the user wrote. The size of the noise is stated in that of the readings; not so of shares, which may
  // be in percent of something else, and of temperatures, whose differences have units of their own.
  bool const by_size = unit.text.empty() && unit.dimension != Dimension{} && unit.dimension != unit_atom("K")->dimension;
  for (ast::Argument const& argument : noise.arguments) {
    bool const is_size = argument.name && (argument.name->text == "sd" || argument.name->text == "scale");
    if (!by_size || !is_size || !std::holds_alternative<ast::Reference>(argument.value.node)) continue;
    auto const size = quiet.expression(argument.value);
    if (size && size->kind == Typed::Kind::known && !size->unit.text.empty() && size->unit.dimension == unit.dimension)
      return size->unit;
  }
  return named_or_coherent(std::move(unit));
}

void ModelChecker::derived() {
  each<ast::Definition>([&](ast::Definition const& definition) {
    auto const value = scope_.definition(definition);  // every definition is looked at, used or not
    if (!value || definition.kind == ast::DefinitionKind::local) return;
    std::string const moving = moving_part(model_.graph, value->node);
    if (definition.kind == ast::DefinitionKind::constant) {
      if (!model_.graph.constant_value(value->node))
        diagnostics_.add(errors::constant_needed(definition.value.span, {"the value of a constant"}));
      return;
    }
    Derived quantity;
    quantity.name = definition.name.name.text;
    quantity.unit = value->kind == Typed::Kind::known ? std::optional(named_or_coherent(value->unit)) : std::nullopt;
    quantity.span = definition.name.name.span;
    quantity.value = solved(value->node);
    quantity.per_sample = !moving.empty();
    if (model_.graph.depends(quantity.value, [](Node const& node) { return is_leaf(node, LeafKind::process); })) {
      diagnostics_.add(errors::process_out_of_place(definition.value.span, "part of a derived quantity"));
      return;
    }
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

}  // namespace sysid
