// Chains on the exact likelihood, from the modes that particles lead to.
#pragma once
#include <vector>

#include "app/candidate.hpp"
#include "report/selection.hpp"

namespace sysid {

struct Polish {
  Findings findings;
  bool interrupted = false;
};

/// Metropolis-Hastings of so many iterations a chain, a fifth of them burn-in, for each model of probability 0.01 or more; modes:
/// of each candidate's likelihood. Fills `polished` and `polished_draws` of the selection. Interrupted, it leaves the models that
/// were not reached without.
Polish polish_candidates(Session& session, std::vector<Candidate> const& candidates, std::vector<std::vector<Mode>> const& modes,
                         std::int64_t samples, std::uint64_t seed, SelectionReport& selection);

}  // namespace sysid
