// One pass over nodes in topological order.
#include "program/binding.hpp"

namespace sysid {
namespace {

Binding of_leaf(LeafKind kind) {
  switch (kind) {
    case LeafKind::parameter:
    case LeafKind::step_length:
      return Binding::parameter;
    case LeafKind::input:
    case LeafKind::input_rate:
    case LeafKind::time:
    case LeafKind::measured:
    case LeafKind::step_size:
    case LeafKind::interval:
    case LeafKind::coefficient:
      return Binding::data;
    default:
      return Binding::step;
  }
}

}  // namespace

Binding BindingTimes::operator()(NodeId id) {
  for (std::size_t i = causes_.size(); i <= id; ++i) {
    Node const& node = graph_[static_cast<NodeId>(i)];
    int const operands = operand_count(node);
    std::uint8_t causes = 0;
    if (node.operation == Operation::leaf)
      causes = static_cast<std::uint8_t>(everything_varies_ ? Binding::step : of_leaf(node.leaf_kind));
    if (operands > 0) causes |= causes_[node.a];
    if (operands > 1) causes |= causes_[node.b];
    if (operands > 2) causes |= causes_[node.c];
    causes_.push_back(causes);
  }
  std::uint8_t const causes = causes_[id];
  return causes == 3 || (causes & 4) != 0 ? Binding::step : static_cast<Binding>(causes);
}

}  // namespace sysid
