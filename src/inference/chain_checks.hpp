// What chains say about themselves: did they move, do they agree, are there enough independent draws.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "inference/convergence.hpp"
#include "inference/finding.hpp"

namespace sysid {

struct ChainReport {
  std::vector<Summary> summaries;              // one per parameter
  std::vector<double> acceptance_rate;         // [chains]
  std::vector<std::uint64_t> distinct_states;  // [chains]
  bool adaptive = true;                        // the proposal fits itself; else the help says that it should
};

/// Bars: acceptance 1 %, 100 distinct states a chain, R-hat 1.01 (loud above 1.05), bulk and tail effective sample size 400.
/// Vehtari et al. 2021, sec. 4, for the last two.
Findings check_chains(ChainReport const& report);

}  // namespace sysid
