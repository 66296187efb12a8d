// Simulations that may be given up: lanes are looked at every few samples, those that are not wanted any more leave, and the rest
// close ranks, so that a block is always full of lanes that matter.
#pragma once
#include <cstdint>
#include <functional>
#include <span>

#include "core/numeric/lanes.hpp"
#include "simulate/simulator.hpp"

namespace sysid {

enum class Ending : std::uint8_t { finished, given_up, failed };

/// Whether lane `lane` of the batch is still wanted, from its sums so far (column `column` of partial [sum_count x any]); a sum
/// that cannot be told before the last sample is 0 there. Must depend on these values alone. Called from several threads at once.
using Wanted = std::function<bool(ConstLanes partial, int column, int lane)>;

/// Runs the simulator's program over its schedule for parameters [parameters x W], SI. out: [sum_count x W], the sums of the lanes
/// that finished, the partial ones of those given up, NaN for the failed. endings, failed_at (a sample; -1: none): [W]. Lanes are
/// looked at after the same samples whatever the width, so a lane's ending depends on its column alone. Lanes of solvers that keep
/// a memory of their own do not move: there a block ends when none of its lanes is wanted. What is given up
/// (ExecutionOptions::stopped) has no results. What the arguments view must outlive the work.
Work wavefront_work(Simulator const& simulator, ConstLanes parameters, Wanted wanted, Lanes out, std::span<Ending> endings,
                    std::span<int> failed_at);

}  // namespace sysid
