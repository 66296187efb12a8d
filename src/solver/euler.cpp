// Euler's explicit method:  y + h f(y, t).
#include "solver/stages.hpp"

namespace sysid {

std::vector<NodeId> euler_step(Stages const& stages) {
  return stages.advance(stages.evaluate(stages.states, Stage::begin), stages.h);
}

}  // namespace sysid
