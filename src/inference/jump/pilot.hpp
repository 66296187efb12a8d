// What is learnt of each model before the chains jump: proposals from short chains within it, and how probable it is about.
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "inference/backend/selector.hpp"
#include "inference/evidence/mixture.hpp"
#include "inference/jump/plan.hpp"

namespace sysid::jump {

struct Pilot {
  marginal::Mixture mixture;  // empty of a model without parameters, and of one that is excluded
  double log_evidence = 0;    // by importance sampling from few draws, in the units of the candidates; -infinity: excluded
  std::string excluded;       // why
};

/// Where the chains of a pilot that was interrupted are kept.
struct KeptPilot {
  std::shared_ptr<nlohmann::json const> stored;  // null: nothing
  std::function<void(nlohmann::json const&)> save;
};

/// Four chains of `mh` from the model's modes (it searches where there are none), a heavy-tailed mixture fitted to them and the
/// modes, and the mean weight of draws of it; again with chains four and sixteen times as long where such draws are worth less than
/// a tenth of their number. Nothing when interrupted; the chains are kept then. Throws checkpoint::Mismatch or a JSON exception.
std::optional<Pilot> explore(LikelihoodCandidate const& candidate, Plan const& plan, RunContext& context, KeptPilot const& kept);

nlohmann::json store(Pilot const& pilot);
Pilot restore_pilot(nlohmann::json const& stored, int dimension);

}  // namespace sysid::jump
