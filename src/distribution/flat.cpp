// The improper priors: densities that no interval normalises.
#include "distribution/rows.hpp"

namespace sysid {
namespace flat_parts {

/// log p = 0 for every x, also between bounds: `flat()` and `flat(lower = 0)` have no evidence and no prior draws.
NodeId flat_log_density(Graph& graph, NodeId, Nodes) { return graph.constant(0); }

/// Lebesgue measure up to x, less an infinite constant: its derivative is the density, and nothing is normalised by it.
NodeId flat_cumulative(Graph&, NodeId x, Nodes) { return x; }

/// log p = -log x for x > 0, so that the logarithm of x is flat: the prior of a scale that does not depend on its unit.
///                                                                                        Jeffreys 1946; Box and Tiao 1973, ch. 1
NodeId log_flat_log_density(Graph& graph, NodeId x, Nodes) { return (-log(Term(graph, x))).id; }
NodeId log_flat_cumulative(Graph& graph, NodeId x, Nodes) { return log(Term(graph, x)).id; }

std::string_view refuse(Numbers) { return {}; }

}  // namespace flat_parts

DistributionRow flat_distribution() {
  using namespace flat_parts;
  return {.name = "flat",
          .arguments = {},
          .proper = false,
          .log_density = &flat_log_density,
          .cumulative = &flat_cumulative,
          .refuse = &refuse,
          .summary = "improper constant density: the posterior must be proper, and the evidence of the model is not defined"};
}

DistributionRow log_flat_distribution() {
  using namespace flat_parts;
  return {.name = "log_flat",
          .arguments = {},
          .proper = false,
          .log_density = &log_flat_log_density,
          .cumulative = &log_flat_cumulative,
          .lower = &zero_bound,
          .refuse = &refuse,
          .summary = "improper density 1/x for x > 0, flat in the logarithm: for sds and other scales; evidence not defined"};
}

}  // namespace sysid
