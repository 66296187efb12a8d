// One pass over all for the samples that any predicts, another for the trajectories that predict all of these.
#include "core/numeric/usable_trajectories.hpp"

#include <algorithm>
#include <cmath>

namespace sysid {

UsableTrajectories usable_trajectories(std::vector<std::vector<double>> const& trajectories) {
  UsableTrajectories out;
  std::vector<char>& predictable = out.predictable;
  predictable.assign(trajectories.empty() ? 0 : trajectories.front().size(), 0);
  for (std::vector<double> const& trajectory : trajectories)
    for (std::size_t i = 0; i < trajectory.size(); ++i) predictable[i] |= std::isfinite(trajectory[i]) ? 1 : 0;
  bool const any = std::find(predictable.begin(), predictable.end(), 1) != predictable.end();
  for (std::vector<double> const& trajectory : trajectories) {
    int missing = 0;
    for (std::size_t i = 0; i < trajectory.size(); ++i) missing |= std::isfinite(trajectory[i]) ? 0 : predictable[i];
    if (any && missing == 0) out.usable.push_back(&trajectory);
  }
  return out;
}

}  // namespace sysid
