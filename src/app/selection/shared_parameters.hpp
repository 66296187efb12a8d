// Parameters that mean the same in several candidates of a selection.
#pragma once
#include <vector>

#include "app/selection/candidate.hpp"
#include "result/selection.hpp"

namespace sysid {

/// Fills `shared` of the selection: averages over the particles of all living models that have the parameter, by the models'
/// probabilities; and `shared_unmoved`: shared names that no particle has, with the reason.
void summarise_shared(Session const& session, CandidateSet const& set, std::vector<Candidate> const& candidates,
                      SelectionReport& selection);

}  // namespace sysid
