// An unknown function that stands in equations: a Gaussian process as a finite sum of known functions.
#pragma once
#include <vector>

#include "expression/graph.hpp"
#include "model/process.hpp"
#include "model/quantity.hpp"

namespace sysid {

/// Its coefficients are parameters with standard normal priors, so that a model that has one is a model like any other.
struct Expansion : Quantity {
  struct Input : Quantity {
    double low, high;  // SI: where the sum stands for the process
  };
  std::vector<Input> inputs;
  Process process;                                // what it stands for: covariance and hyper-parameters; no arguments
  std::vector<int> coefficients;                  // parameters of the model
  NodeId value = 0;                               // in the leaves `argument` and parameters, SI
  std::vector<std::vector<NodeId>> applications;  // of each its arguments, SI

  /// The leaf that stands for an input in `value`.
  static NodeId argument(Graph& graph, int input) { return graph.leaf(LeafKind::unknown, -1 - input); }
};

}  // namespace sysid
