// What one fit of an average predicts along a record: its trajectories with the moments of their noise, and the log densities of
// the scored samples.
#pragma once
#include <string>
#include <vector>

#include "app/session/posterior_trajectories.hpp"
#include "result/finding.hpp"

namespace sysid {

/// A channel, state or derived quantity along rows of a record, in one unit for all members.
struct MemberQuantity {
  std::string name, unit;
  bool channel = false;
  bool comparable = true;                   // with that of its name in the model that gives the units
  std::vector<std::vector<double>> values;  // [draws][rows]
  std::vector<std::vector<double>> noisy;   // of a channel: the same, or several times the draws one after another
  std::vector<std::vector<double>> noise_mean, noise_variance;  // of a channel [draws][rows]
  /// [rows] of each scored sample the log of the mean density over the draws that are solved, of the unit; -infinity where it is
  /// impossible by all of them; NaN where there is no sample.
  std::vector<double> log_density;
  bool logarithmic = false;  // a channel whose noise multiplies it
};

struct MemberAlong {
  Experiment experiment;
  std::vector<MemberQuantity> quantities;
  Ledger ledger;
  Findings findings;  // of functions that are read out of their range, and of constraints that drift
};

/// units: the model in whose units all are.
MemberAlong run_along(Session& session, PosteriorTrajectories const& member, int experiment, Model const& units);

/// The rows of the file that all have, in all of them: models that look back further begin later.
void cut_to_common_rows(std::vector<MemberAlong>& members);

}  // namespace sysid
