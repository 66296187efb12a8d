// Checks of chains: whether they moved, whether they agree, whether there are enough independent draws.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "result/draws.hpp"
#include "result/finding.hpp"
#include "result/summary.hpp"

namespace sysid {

// What chains are held to; Vehtari et al. 2021, sec. 4, for R-hat and the effective sample sizes, bulk and tail.
inline constexpr double least_acceptance = 0.01;
inline constexpr std::uint64_t least_distinct = 100;  // states a chain
inline constexpr double rhat_threshold = 1.01, rhat_far_above = 1.05;
inline constexpr double ess_threshold = 400;

struct ChainReport {
  std::vector<Summary> summaries;              // one per parameter
  std::vector<double> acceptance_rate;         // [chains]
  std::vector<std::uint64_t> distinct_states;  // [chains]
  bool adaptive = true;                        // the proposal fits itself; else the help says that it should
  Draws const* draws = nullptr;                // of the same parameters: whether chains that disagree lie apart
  bool exchanges = false;                      // replica exchange: it is not advised where it is in use
};

/// By the bars above; where R-hat is above the loud one, in louder words.
Findings check_chains(ChainReport const& report);

}  // namespace sysid
