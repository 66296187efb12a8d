// Binding times: when the value of a sub-expression is known, and so how often it must be computed.
#pragma once
#include <cstdint>
#include <vector>

#include "expression/graph.hpp"

namespace sysid {

/// Bits of a set of causes of variation; the empty set is a constant.
enum class Binding : std::uint8_t {
  constant = 0,
  parameter = 1,  // once per parameter vector and experiment: one value per lane, in the prologue
  data = 2,       // once per data set and step or sample: one value for all lanes
  step = 4,       // at every step, in every lane
};

/// Binding times of a growing graph. Parameters vary by lane, a step that is the same all along an experiment goes with them;
/// inputs, time, measurements and other steps vary by sample; what depends on both, on states or on place holders
/// (LeafKind::unknown) is computed at every step.
class BindingTimes {
 public:
  /// everything_varies: all leaves count as step (kernels).
  explicit BindingTimes(Graph const& graph, bool everything_varies = false)
      : graph_(graph), everything_varies_(everything_varies) {}

  Binding operator()(NodeId id);
  bool is_step(NodeId id) { return (*this)(id) == Binding::step; }

 private:
  Graph const& graph_;
  bool everything_varies_;
  std::vector<std::uint8_t> causes_;  // of every node so far
};

}  // namespace sysid
