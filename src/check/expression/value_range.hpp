// Between which values an expression of parameters lies, as far as their priors and its structure show.
#pragma once
#include <map>

#include "model/model.hpp"

namespace sysid {

/// Closed, ends may be infinite. empty: it has no value at all, as the root of what is always negative.
struct ValueRange {
  double low, high;
  bool empty = false;
};

/// Never too narrow, but where it says empty or one-sided it is so: supports of priors, sums, products, quotients, roots, powers
/// and absolute values are followed, all else is taken for any number.
class ValueRanges {
 public:
  /// The priors of the model do not read each other in a circle.
  explicit ValueRanges(Model const& model) : model_(model), graph_(model.graph) {}
  ValueRange of(NodeId root);

 private:
  ValueRange of_parameter(int index);
  ValueRange of_operation(Node const& node);

  Model const& model_;
  Graph graph_;  // bounds of priors are expressions that the model need not hold
  std::map<NodeId, ValueRange> known_;
};

}  // namespace sysid
