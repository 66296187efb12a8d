// Batches divided among ranks: each does its lanes, and all have all results.
#pragma once
#include <span>
#include <vector>

#include "simulate/simulator.hpp"

namespace sysid {

/// Lanes [first, first + count) of a piece of work.
struct LaneRange {
  int first = 0, count = 0;
};

/// The lanes of each piece that fall to a rank. All ranks together have each lane once; pieces that are too small to be divided go
/// round.
std::vector<LaneRange> lanes_of_rank(std::span<Work const> work, int rank, int ranks);

/// Does the work together with the other ranks, if there are any here (ranks::together) and it is worth the messages; else false,
/// the same on all ranks, with nothing done.
bool do_share(std::span<Work const> work, ThreadPool* pool);

/// On this rank alone.
void do_blocks(std::span<Blocks const> pieces, ThreadPool* pool);

}  // namespace sysid
