// Failed solves on their way into the ledger: the first few are traced to a sub-expression, the others counted.
#pragma once
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/system/ledger.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

/// A sub-expression in the user's words.
using Describe = std::function<std::string(NodeId, Graph const&)>;

/// How a batch of lanes was simulated.
struct SolvedBatch {
  Simulator const& simulator;
  ConstLanes parameters;         // [parameters x W], SI, an estimated start included
  bool start_estimated = false;  // a start that was not found is NaN in the last row
  std::string on;                // " on `bench`" where there are several experiments
};

/// Adds the solves of a batch and those that failed, outcome: [W], with their class, place and time. describe: empty for "the
/// model"; example: the declared parameters of a lane, for the first of each kind. Where Interrupted is thrown on the way
/// (ExecutionOptions::throws), failures of batches before may have been added: `all_or_nothing`.
void record_failures(SolvedBatch const& batch, std::span<Outcome const> outcome, Describe const& describe,
                     std::function<std::vector<double>(int lane)> const& example, Ledger& ledger);

/// `record` adds what belongs together to a ledger, which stays as it was where that throws.
void all_or_nothing(Ledger& ledger, std::function<void()> const& record);

}  // namespace sysid
