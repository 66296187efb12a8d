// Names that the block does not have, and where the ranges stand.
#include "experiment/new_ranges.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace sysid {
namespace {

/// "part_1", ... or "train_1", ..., none of which the block has.
std::vector<std::string> new_names(DataBlock const& block, std::string const& stem, std::size_t count) {
  std::vector<std::string> names;
  for (int k = 1; names.size() < count; ++k) {
    std::string name = fmt::format("{}_{}", stem, k);
    if (std::none_of(block.parts.begin(), block.parts.end(), [&](DataPart const& each) { return each.name == name; }))
      names.push_back(std::move(name));
  }
  return names;
}

}  // namespace

std::string new_ranges(DataBlock const& block, int part, std::vector<RowRange> const& ranges) {
  DataPart const* const old = part < 0 ? nullptr : &block.parts[static_cast<std::size_t>(part)];
  std::vector<std::string> const names = new_names(block, old == nullptr ? "part" : old->name, ranges.size());
  std::string split, uses;
  for (std::size_t k = 0; k < ranges.size(); ++k) {
    std::string const comma = k == 0 ? "" : ", ";
    split += fmt::format("{}{} = rows {}..{}", comma, names[k], ranges[k].first, ranges[k].last);
    uses += fmt::format("{}{}.{}", comma, block.name, names[k]);
  }
  std::string const where =
      old != nullptr        ? fmt::format("in `{}` write `{}` in place of the range `{}`", block.name, split, old->name)
      : block.parts.empty() ? fmt::format("write `split {}` in `{}`", split, block.name)
                            : fmt::format("write `split {}` in `{}` in place of its `split`", split, block.name);
  return fmt::format("{}, and fit to `{}`", where, uses);
}

}  // namespace sysid
