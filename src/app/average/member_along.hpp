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
  std::vector<std::vector<double>> values, noisy;               // [draws][rows]; noisy: of a channel
  std::vector<std::vector<double>> noise_mean, noise_variance;  // the same
  std::vector<double> log_density;  // [rows] of each scored sample the mean over draws, of the unit; NaN where there is none
};

struct MemberAlong {
  Experiment experiment;
  std::vector<MemberQuantity> quantities;
  Ledger ledger;
  Findings findings;  // of functions that are read out of their range, and of constraints that drift
};

/// units: the channels of the model in whose units all are.
MemberAlong run_along(Session& session, PosteriorTrajectories const& member, int experiment, std::vector<Channel> const& units);

/// The rows of the file that all have, in all of them: models that look back further begin later.
void cut_to_common_rows(std::vector<MemberAlong>& members);

}  // namespace sysid
