// Whether data lie where a prediction says.
#pragma once
#include "report/report.hpp"

namespace sysid {

/// Whether some channel leaves its 95 % band far more often than it should: a warning for each. fed_back: the noise of a sample
/// shows in later ones, which a free run leaves out.
bool add_coverage(Report& report, bool fed_back);

}  // namespace sysid
