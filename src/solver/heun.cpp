// Heun's method:  k1 = f(y, t), k2 = f(y + h k1, t + h),  y + h/2 (k1 + k2).
#include "solver/stages.hpp"

namespace sysid {

std::vector<NodeId> heun_step(Stages const& stages) {
  Graph& graph = stages.graph;
  std::vector<NodeId> const k1 = stages.evaluate(stages.states, Stage::begin);
  std::vector<NodeId> const k2 = stages.evaluate(stages.advance(k1, stages.h), Stage::end);
  std::vector<NodeId> slopes;
  for (std::size_t i = 0; i < k1.size(); ++i) slopes.push_back(graph.add(k1[i], k2[i]));
  return stages.advance(slopes, graph.multiply(graph.constant(0.5), stages.h));
}

}  // namespace sysid
