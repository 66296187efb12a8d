// The weights of the fits of an averaged prediction, from their stored results, as `compare` has them.
#pragma once
#include <string>
#include <vector>

#include "app/session/session.hpp"
#include "result/average.hpp"
#include "result/comparison.hpp"
#include "result/finding.hpp"

namespace sysid {

struct MemberWeights {
  std::vector<AveragedMember> members;  // weights sum to 1
  Findings findings;
  std::vector<std::string> notes;  // of the comparison: what the widths of priors change, and where fits disagree
};

/// The results of all members are complete. UserError (E6704, E6705) at the task where a fit has nothing to be weighed by, or where
/// `compare` refuses the fits.
MemberWeights weigh_members(Session& session, Task const& task, PredictTask const& what);

/// The same of a comparison of the fits in their order. fits: their names. UserError without a place.
MemberWeights weights_of(Comparison const& comparison, std::vector<std::string> const& fits, AverageWeights by);

}  // namespace sysid
