// Counts of replications.
#include "result/calibration.hpp"

#include <algorithm>

namespace sysid {

int CalibrationReport::with_draws() const {
  return static_cast<int>(std::count_if(records.begin(), records.end(), [](Replication const& each) { return each.has_draws(); }));
}

}  // namespace sysid
