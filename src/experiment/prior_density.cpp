// Densities are expressions: with numbers as arguments they need no model.
#include "experiment/prior_density.hpp"

#include <cmath>
#include <memory>

#include "core/numeric/elementary.hpp"

namespace sysid {

namespace {

/// Within the truncation: the p-quantile of what the bounds leave of the distribution.
std::optional<double> quantile_of(Graph& graph, Distribution const& use, std::vector<double> const& arguments,
                                  std::optional<double> lower, std::optional<double> upper, double p) {
  if (!use.row->proper) {
    if (!lower || !upper) return std::nullopt;
    return *lower + p * (*upper - *lower);
  }
  if (use.row->quantile == nullptr || use.row->cumulative == nullptr) return std::nullopt;
  auto const below = [&](std::optional<NodeId> bound, double otherwise) {
    if (!bound) return otherwise;
    return graph.evaluate(use.row->cumulative(graph, *bound, use.arguments), [](NodeId) { return std::nan(""); });
  };
  double const first = below(use.lower, 0), last = below(use.upper, 1);
  double const value = use.row->quantile(first + p * (last - first), Tail::lower, arguments);
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

}  // namespace

std::optional<PriorNumbers> prior_numbers(Parameter const& parameter, Model const& model) {
  Graph graph = model.graph;
  Distribution const& use = *parameter.prior;
  PriorNumbers numbers;
  bool free = false;
  auto const number = [&](NodeId node) {
    free = free || graph.depends(node, [](Node const& each) { return each.operation == Operation::leaf; });
    return free ? std::nan("") : graph.evaluate(node, [](NodeId) { return std::nan(""); });
  };
  numbers.distribution = use.row->name;
  for (NodeId const argument : use.arguments) numbers.arguments.push_back(number(argument));
  if (use.lower) numbers.lower = number(*use.lower);
  if (use.upper) numbers.upper = number(*use.upper);
  if (parameter.unit) numbers.scale = parameter.unit->scale;
  return free ? std::nullopt : std::optional(numbers);
}

void add_density(PriorInfo& prior) {
  if (!prior.numbers) return;
  PriorNumbers const& numbers = *prior.numbers;
  DistributionRow const* row = find_distribution(numbers.distribution);
  if (row == nullptr || row->arguments.size() != numbers.arguments.size()) return;
  auto graph = std::make_shared<Graph>();
  Distribution use{row, {}, {}, {}};
  for (double const argument : numbers.arguments) use.arguments.push_back(graph->constant(argument));
  if (numbers.lower) use.lower = graph->constant(*numbers.lower);
  if (numbers.upper) use.upper = graph->constant(*numbers.upper);
  Support const bounds = support(*graph, use);
  auto const lower = bounds.lower ? graph->constant_value(*bounds.lower) : std::nullopt;
  auto const upper = bounds.upper ? graph->constant_value(*bounds.upper) : std::nullopt;
  for (auto const& [p, into] : {std::pair(0.05, &prior.q5), std::pair(0.95, &prior.q95), std::pair(0.0005, &prior.lowest),
                                std::pair(0.9995, &prior.highest)})
    if (auto const value = quantile_of(*graph, use, numbers.arguments, lower, upper, p)) *into = *value / numbers.scale;
  NodeId const x = graph->leaf(LeafKind::unknown, 0);
  NodeId const root = log_density(*graph, use, x);
  prior.density = [graph, root, lower, upper, scale = numbers.scale](double declared) {
    double const si = declared * scale;
    if ((lower && si <= *lower) || (upper && si >= *upper)) return 0.0;
    return scale * elementary::exp(graph->evaluate(root, [&](NodeId) { return si; }));
  };
}

}  // namespace sysid
