// Chains on the exact likelihood, started at the modes that were found from particles.
#pragma once
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "app/selection/candidate_posterior.hpp"
#include "result/selection.hpp"

namespace sysid {

struct McmcRefinement {
  Findings findings;
  bool interrupted = false;
};

/// Where the chains of each model are kept, by its index.
struct KeptChains {
  std::function<std::shared_ptr<nlohmann::json const>(std::size_t model)> stored;  // null: nothing
  std::function<void(std::size_t model, nlohmann::json const& state)> save;
  double interval;  // seconds between two states of one model
};

/// Metropolis-Hastings of so many iterations a chain, a fifth of them burn-in, for each model of probability 0.01 or more, from the
/// modes and with the solver of its posterior. Fills `refined` and `refined_draws` of the selection; not of models without
/// parameters, and not, which is said, where a climb was given up or none ended at a finite likelihood. Interrupted, it leaves the
/// models that were not reached without. Chains go on from `kept`; throws checkpoint::Mismatch where that is of others.
McmcRefinement refine_with_chains(Session& session, std::vector<Candidate> const& candidates,
                                  std::vector<CandidatePosterior> const& posteriors, std::int64_t samples, std::uint64_t seed,
                                  KeptChains const& kept, SelectionReport& selection);

}  // namespace sysid
