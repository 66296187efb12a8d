// Distributions that are a standard one moved and widened on the sampler's unbounded scale.
#pragma once
#include <optional>

#include "distribution/distribution.hpp"

namespace sysid {

/// Of the sampler's coordinate w, which is x, or log x of a log-normal x: (w - location)/scale has a distribution that depends on
/// neither.
struct LocationScale {
  NodeId location, scale;
};

/// Its scale alone; nothing where the distribution is none of these, or is truncated.
std::optional<NodeId> scale_argument(Distribution const& use);
/// Both, of a distribution that has a `scale_argument`.
LocationScale location_scale(Graph& graph, Distribution const& use);
/// The one with location 0 and scale 1 of that family.
Distribution standard(Graph& graph, Distribution use);

}  // namespace sysid
