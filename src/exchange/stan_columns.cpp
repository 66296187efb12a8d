// Columns in the order in which the equations use them.
#include "exchange/stan_columns.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sysid {

std::string StanColumns::text(Node const& leaf, std::string_view row) {
  auto const same = [&](UniformLeaf const& each) {
    return each.kind == leaf.leaf_kind && each.index == leaf.index && each.lag == leaf.lag;
  };
  auto place = std::find_if(leaves_.begin(), leaves_.end(), same);
  if (place == leaves_.end())
    place = leaves_.insert(leaves_.end(), {leaf.leaf_kind, leaf.index, Stage::begin, static_cast<int>(leaf.lag)});
  return fmt::format("{}[{}]", row, place - leaves_.begin() + 1);
}

}  // namespace sysid
