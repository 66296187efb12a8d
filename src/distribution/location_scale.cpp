// Which arguments of which distributions are location and scale.
#include "distribution/location_scale.hpp"

#include <algorithm>

#include "function/primitive.hpp"

namespace sysid {
namespace {

struct Family {
  std::string_view name;
  std::size_t location, scale;  // arguments
  bool logarithmic;             // the location is the logarithm of its argument
};
constexpr Family families[] = {{"normal", 0, 1, false}, {"student_t", 0, 2, false}, {"log_normal", 0, 1, true}};

Family const* family_of(Distribution const& use) {
  if (use.lower || use.upper) return nullptr;
  auto const* const found =
      std::find_if(std::begin(families), std::end(families), [&](Family const& each) { return each.name == use.row->name; });
  return found == std::end(families) ? nullptr : found;
}

}  // namespace

std::optional<NodeId> scale_argument(Distribution const& use) {
  Family const* const family = family_of(use);
  return family == nullptr ? std::nullopt : std::optional(use.arguments[family->scale]);
}

LocationScale location_scale(Graph& graph, Distribution const& use) {
  Family const& family = *family_of(use);
  NodeId const location = use.arguments[family.location];
  return {family.logarithmic ? graph.call(log_function, location) : location, use.arguments[family.scale]};
}

Distribution standard(Graph& graph, Distribution use) {
  Family const& family = *family_of(use);
  use.arguments[family.location] = graph.constant(family.logarithmic ? 1 : 0);
  use.arguments[family.scale] = graph.constant(1);
  return use;
}

}  // namespace sysid
