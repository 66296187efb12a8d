// An unknown function of a model: a Gaussian process, its covariance as the user wrote it.
#pragma once
#include <string>
#include <vector>

#include "expression/graph.hpp"
#include "gaussian_process/kernel.hpp"
#include "model/quantity.hpp"

namespace sysid {

/// A kernel on some of the process's inputs, and its hyper-parameters in the order of the kernel's row, one for each input where
/// they belong to inputs: expressions of parameters, SI.
struct KernelUse {
  gaussian_process::KernelRow const* row = nullptr;
  std::vector<int> inputs;
  std::vector<NodeId> hyper_parameters;
};

/// What the function is known to be: 0 at a point, or its first derivative there in one input.
struct ProcessCondition {
  std::vector<double> point;  // one for each input, SI
  int derivative = -1;        // in which input; -1: the value
};

/// Leaf process(i) is its value at the present sample, at `arguments`. Its unit is that of the function's values.
struct Process : Quantity {
  std::vector<Quantity> inputs;
  std::vector<KernelUse> kernels;
  /// Sums and products of kernels behind their operands; the last is the whole. Of a kernel `left` is its place in `kernels`.
  struct Covariance {
    enum class Kind { kernel, sum, product } kind = Kind::kernel;
    int left = 0, right = 0;
  };
  std::vector<Covariance> covariance;
  std::vector<ProcessCondition> conditions;
  std::vector<NodeId> arguments;  // one for each input, SI
  std::vector<int> lags;          // likewise: how many samples back it is read; -1: it is no element of `lags(...)`
  int channel = -1;               // whose centre has it as an addend
};

/// All that processes read: their arguments and hyper-parameters.
std::vector<NodeId> read_by(std::vector<Process> const& processes);

/// An expression with every process at zero, the mean of its prior.
NodeId without_processes(Graph& graph, NodeId root);

}  // namespace sysid
