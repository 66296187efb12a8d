// `sysid calibrate`: simulation-based calibration of the fit tasks of a file (Talts et al. 2018; Modrák et al. 2023).
#pragma once
#include <string>

#include "app/session/session.hpp"
#include "inference/backend/backend.hpp"

namespace sysid {

struct CalibrateOptions {
  std::string task;  // empty: all fit tasks
  int replications = 200;
  BackendRow const* backend = nullptr;  // tests: in place of the task's own
};

/// Calibrates the fit tasks that are asked for, in order, each into a folder of its name in the output folder. The worst exit code;
/// UserError where there is nothing to calibrate, or a task cannot be calibrated, with the reason.
ExitCode calibrate(Session& session, CalibrateOptions const& options);

}  // namespace sysid
