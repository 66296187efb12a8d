// The density of a distribution as used: truncated where the user gave bounds, and normalised again.
#include <limits>

#include "distribution/distribution.hpp"
#include "function/primitive.hpp"

namespace sysid {

NodeId mass(Graph& graph, Distribution const& use) {
  DistributionRow const& row = *use.row;
  Support const inside = support(graph, use);
  // A bound that is the natural one cuts nothing off.
  auto const cuts = [&](std::optional<NodeId> const& bound, auto natural) {
    if (!bound || natural == nullptr) return bound.has_value();
    NodeId const at = natural(graph, use.arguments);
    auto const number = graph.constant_value(*bound), there = graph.constant_value(at);
    return *bound != at && !(number && there && *number == *there);  // -0 is another node than 0
  };
  bool const below = cuts(inside.lower, row.lower), above = cuts(inside.upper, row.upper);
  if (!row.proper || !(below || above)) return graph.constant(1);
  auto const cumulative = [&](NodeId x) { return Term(graph, row.cumulative(graph, x, use.arguments)); };
  auto const survival = [&](NodeId x) { return Term(graph, row.survival(graph, x, use.arguments)); };
  if (!above) return survival(*inside.lower).id;
  if (!below) return cumulative(*inside.upper).id;
  // A difference of probabilities near 1 has no digits left: in the upper half it is taken between survivals.
  Term const to_lower = cumulative(*inside.lower);
  Term const near_lower = cumulative(*inside.upper) - to_lower, beyond = survival(*inside.upper),
             near_upper = survival(*inside.lower) - beyond;
  return select(less(Term(graph, 0.5), to_lower), near_upper, near_lower).id;
}

NodeId log_density(Graph& graph, Distribution const& use, NodeId x) {
  Term const density(graph, use.row->log_density(graph, x, use.arguments));
  Term const inside(graph, mass(graph, use));
  // No mass: no density anywhere, instead of an infinite one.
  Term const nothing(graph, std::numeric_limits<double>::infinity()), logarithm = log(inside);
  Term const log_inside = select(less(Term(graph, 0.0), inside), logarithm, nothing);
  return (density - log_inside).id;
}

}  // namespace sysid
