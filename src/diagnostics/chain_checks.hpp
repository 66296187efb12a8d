// Checks of chains: whether they moved, whether they agree, whether there are enough independent draws; limits and messages. The
// numbers that are compared with the limits are computed in diagnostics/convergence.cpp.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "result/draws.hpp"
#include "result/finding.hpp"
#include "result/summary.hpp"

namespace sysid {

// The limits; for R-hat and the effective sample sizes, bulk and tail, those of Vehtari et al. 2021, sec. 4.
inline constexpr double least_acceptance = 0.01;
inline constexpr std::uint64_t least_distinct = 100;  // states a chain
inline constexpr double rhat_threshold = 1.01, rhat_far_above = 1.05;
inline constexpr double ess_threshold = 400;

struct ChainReport {
  std::vector<Summary> summaries;              // one per parameter
  std::vector<double> acceptance_rate;         // [chains]
  std::vector<std::uint64_t> distinct_states;  // [chains]
  bool adaptive = true;                        // the proposal adapts; else the help recommends that it does
  Draws const* draws = nullptr;                // of the same parameters: whether chains that disagree lie apart
  bool exchanges = false;                      // by replica exchange: the help then does not recommend it
};

/// Findings by the limits above. An R-hat above `rhat_far_above` is `chains_disagree`, one between the two limits
/// `chains_not_quite_agreed`.
Findings check_chains(ChainReport const& report);

}  // namespace sysid
