// The evidence of a model: likelihood times prior, integrated over the parameters. Which method computes it.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "core/setting/evidence_method.hpp"
#include "likelihood/target.hpp"
#include "result/draws.hpp"
#include "result/evidence.hpp"
#include "result/mode.hpp"
#include "search/objective_kind.hpp"

namespace sysid {

/// What a fit leaves for its evidence.
struct EvidenceTask {
  EvidenceMethod method = EvidenceMethod::automatic;
  ObjectiveKind objective_kind;    // of the modes
  std::vector<Mode> const& modes;  // of the search; may be none
  Draws const& draws;              // of the sampled parameters; of `map` the optimum alone
  std::uint64_t simulations = 0;   // that the fit took: an evidence takes a tenth of them at most
  std::uint64_t seed = 0;
};

/// By `method`; automatic:
///
/// with draws: half of them give a mixture of normal and Student's t distributions, whose own draws are simulated in rounds that
/// double until an error of 0.02 is reached or the simulations are used up. From these the evidence follows by importance sampling;
/// with the other half of the posterior's draws by bridge sampling. The first stands where its weights are healthy and the second
/// does not contradict it, the second where it has overlap. Where neither is believed, tempered SMC may take half of the fit's
/// simulations; where it does not arrive, the number stands with the reason for the doubt.
///
/// without: Laplace's approximation at the modes, in whose place weighted draws around the modes stand where they are precise.
///
/// `none`, and `likelihood` as objective kind, give none with the reason.
Evidence estimate_evidence(Target const& target, EvidenceTask const& task, Ledger& ledger, std::function<bool()> const& stop = {});

}  // namespace sysid
