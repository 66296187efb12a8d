// The classical fourth-order Runge-Kutta method (Kutta 1901):
//   k1 = f(y, t), k2 = f(y + h/2 k1, t + h/2), k3 = f(y + h/2 k2, t + h/2), k4 = f(y + h k3, t + h),  y + h/6 (k1 + 2 (k2 + k3) +
//   k4).
#include "solver/stages.hpp"

namespace sysid {

std::vector<NodeId> rk4_step(Stages const& stages) {
  Graph& graph = stages.graph;
  NodeId const half = graph.multiply(graph.constant(0.5), stages.h);
  NodeId const sixth = graph.divide(stages.h, graph.constant(6));
  std::vector<NodeId> const k1 = stages.evaluate(stages.states, Stage::begin);
  std::vector<NodeId> const k2 = stages.evaluate(stages.advance(k1, half), Stage::middle);
  std::vector<NodeId> const k3 = stages.evaluate(stages.advance(k2, half), Stage::middle);
  std::vector<NodeId> const k4 = stages.evaluate(stages.advance(k3, stages.h), Stage::end);
  std::vector<NodeId> slopes;
  for (std::size_t i = 0; i < k1.size(); ++i) {
    NodeId const middle = graph.multiply(graph.constant(2), graph.add(k2[i], k3[i]));
    slopes.push_back(graph.add(graph.add(k1[i], k4[i]), middle));
  }
  return stages.advance(slopes, sixth);
}

}  // namespace sysid
