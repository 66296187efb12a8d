// A calibration as a report: tables, settings and findings.
#pragma once
#include "app/calibration/replicate.hpp"
#include "result/report.hpp"

namespace sysid {

/// calibration: of the plan's task.
Report calibration_report(Session const& session, CalibrationPlan const& plan, CalibrationReport calibration);

}  // namespace sysid
