// An order of evaluation for code that holds many values at once.
#pragma once
#include <cstddef>
#include <vector>

namespace sysid {

/// Of operations that are given in an order of evaluation, another one. operands: of each operation those that are operations too,
/// each once; kept: whether its value is wanted at the end. What is the last to read a value comes as soon as it can, since it
/// needs no register more; else the order is as given.
std::vector<std::size_t> eager_order(std::vector<std::vector<std::size_t>> const& operands, std::vector<bool> const& kept);

}  // namespace sysid
