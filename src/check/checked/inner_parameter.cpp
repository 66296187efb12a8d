// Draws by the streams of priors; leaves replaced by constants.
#include "check/checked/inner_parameter.hpp"

#include <algorithm>
#include <cmath>

#include "core/numeric/random.hpp"

namespace sysid {

double log_density(InnerParameter const& parameter, double value) {
  Graph graph;
  Distribution use{parameter.prior, {}, {}, {}};
  for (double const each : parameter.arguments) use.arguments.push_back(graph.constant(each));
  if (std::isfinite(parameter.lower)) use.lower = graph.constant(parameter.lower);
  if (std::isfinite(parameter.upper)) use.upper = graph.constant(parameter.upper);
  Support const inside = support(graph, use);
  auto const number = [&](NodeId node) { return graph.constant_value(node).value(); };
  if ((inside.lower && !(value > number(*inside.lower))) || (inside.upper && !(value < number(*inside.upper))))
    return -std::numeric_limits<double>::infinity();
  return number(log_density(graph, use, graph.constant(value)));
}

std::vector<double> sorted_draws(InnerParameter const& parameter, int count) {
  std::vector<double> draws;
  for (int i = 0; i < count; ++i) {
    Stream stream({0, Purpose::prior, static_cast<std::uint64_t>(i), 0});
    draws.push_back(draw(*parameter.prior, parameter.arguments, parameter.lower, parameter.upper, stream));
  }
  std::sort(draws.begin(), draws.end());
  return draws;
}

regression::Dictionary with_inner(regression::Dictionary dictionary, OpenTerms const& open,
                                  std::span<InnerParameter const> parameters, std::span<double const> values) {
  Graph& graph = dictionary.graph;
  auto const number = [&](NodeId leaf) -> std::optional<NodeId> {
    for (std::size_t p = 0; p < parameters.size(); ++p)
      if (parameters[p].leaf == leaf) return graph.constant(values[p]);
    return std::nullopt;
  };
  for (std::size_t e = 0; e < open.size(); ++e)
    for (std::size_t t = 0; t < open[e].size(); ++t)
      dictionary.equations[e].terms[t].expression = graph.substitute(open[e][t], number);
  return dictionary;
}

}  // namespace sysid
