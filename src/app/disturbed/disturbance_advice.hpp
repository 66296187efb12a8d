// Whether a higher evidence with a disturbance is a reason to prefer that model: a disturbance also compensates for missing terms
// and for faults of the record.
#pragma once
#include <string>
#include <vector>

#include "app/disturbed/explained_share.hpp"
#include "result/finding.hpp"

namespace sysid {

/// The findings of both fits, without notes.
struct FoundByBoth {
  Findings without, with;
};

/// size: of the evidence, "log Bayes factor +22.2". The fit with the disturbance is preferred unless
/// - a finding names a fault of the record, as a sensor that was stuck, or the fit with the disturbance still has one of its
///   inputs, or an offset: the disturbance stands in for the fault;
/// - it follows the states: it stands in for a term;
/// - the equations explain much less with its parameters than with those of the other fit: it stands in for what was measured.
/// Where the fit without it alone has a finding about its inputs, a force that was not measured may have caused that as well.
std::string advice_on_disturbance(std::string const& size, FoundByBoth const& found, ExplainedShares const& shares);

}  // namespace sysid
