// A value that is the same in all lanes at a step or sample, as raw data before tables are computed.
#pragma once
#include "expression/graph.hpp"

namespace sysid {

struct UniformLeaf {
  LeafKind kind = LeafKind::time;  // input, input_rate, time, measured, step_size, step_length
  int index = 0;
  Stage stage = Stage::begin;
  int lag = 0;  // samples back
};

}  // namespace sysid
