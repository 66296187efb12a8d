// The flat, improper prior: a constant density that no interval normalises.
#include "distribution/rows.hpp"

namespace sysid {
namespace flat_parts {

/// log p = 0 for every x, also between bounds: `flat()` and `flat(lower = 0)` have no evidence and no prior draws.
NodeId log_density(Graph& graph, NodeId, Nodes) { return graph.constant(0); }

/// Lebesgue measure up to x, less an infinite constant: its derivative is the density, and nothing is normalised by it.
NodeId cumulative(Graph&, NodeId x, Nodes) { return x; }

std::string_view refuse(Numbers) { return {}; }

}  // namespace flat_parts

DistributionRow flat_distribution() {
  using namespace flat_parts;
  return {.name = "flat",
          .arguments = {},
          .proper = false,
          .log_density = &log_density,
          .cumulative = &cumulative,
          .refuse = &refuse,
          .summary = "improper constant density; has no prior draws, so no back end accepts it"};
}

}  // namespace sysid
