// How expressions of one model use its samples: `lag`, `measured`, `predicted`, `residual`, `since_last`.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/numeric/unit.hpp"
#include "core/text/source.hpp"
#include "expression/graph.hpp"

namespace sysid {

struct SampleNames {
  struct Channel {
    int index = 0;
    std::optional<Unit> unit;  // as declared after its name
  };
  bool discrete = false;     // the model's time is
  bool in_equation = false;  // what is looked at is an equation: data and changes of them have no place in a differential one
  int states = 0;            // declared ones
  std::map<std::string, Channel> channels;
  std::vector<NodeId> memories;  // arguments of `since_last`, each once

  // Place holders, replaced when the whole model is known:
  //   previous(state i, lag k >= 1)               a state, k samples back
  //   previous(states + channel c, lag k >= 0)    what channel c predicts, k samples back
  //   previous(states + channels + disturbance d, lag k >= 1)
  //   previous(memory i, lag 1)                   of a continuous-time model: the memory's value at the sample before
  NodeId state(Graph& graph, int index, int lag) const { return graph.leaf(LeafKind::previous, index, Stage::begin, lag); }
  NodeId predicted(Graph& graph, int channel, int lag) const {
    return graph.leaf(LeafKind::previous, states + channel, Stage::begin, lag);
  }
  NodeId memory(Graph& graph, int index) const { return graph.leaf(LeafKind::previous, index, Stage::begin, 1); }
};

/// `root` as it was `lag` samples back: all that moves in it, parameters and constants stay. disturbances: index of the first among
/// what has lags; theirs are the states that stand in an expression of discrete time.
NodeId lagged(Graph& graph, NodeId root, int lag, int disturbances);

}  // namespace sysid
