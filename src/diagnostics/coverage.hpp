// Whether data lie within the bands of a prediction, and the verdict of the prediction.
#pragma once
#include "result/report.hpp"

namespace sysid {

/// Whether some channel leaves its 95 % band far more often than it should: a warning for each. fed_back: the noise of a sample
/// shows in later ones, which a free run leaves out.
bool add_coverage(Report& report, bool fed_back);

/// What a prediction's bands allow, from its findings and failures; missed: as `add_coverage` says.
std::string prediction_verdict(Report const& report, bool missed);

}  // namespace sysid
