// One finding per constraint, with its text.
#include "diagnostics/drift.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace sysid {
namespace {

constexpr double tolerable_drift = 1e-3;

}  // namespace

Findings drift_findings(Source const& source, Model const& model, Trajectory::Result const& result, std::string const& record) {
  Findings findings;
  for (std::size_t i = 0; i < model.invariants.size(); ++i) {
    double largest = -1;
    for (double const drift : result.drift[i])
      if (std::isfinite(drift)) largest = std::max(largest, drift);
    if (largest < 0) continue;  // nothing could be simulated, which other findings report
    findings.push_back(
        {FindingCode::constraint_drift,
         largest > tolerable_drift ? Severity::warning : Severity::note,
         {record},
         fmt::format("the solution does not satisfy the constraint `{}` exactly; its largest relative violation on {} is {:.2g}",
                     source.text(model.invariants[i].span), record, largest),
         largest > tolerable_drift ? "integrate more accurately: more `substeps`, or a smaller `relative`" : ""});
  }
  return findings;
}

}  // namespace sysid
