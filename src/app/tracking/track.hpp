// `sysid track`: states and parameters of a fit, updated as rows arrive; alarms where a parameter has changed.
#pragma once
#include "app/tracking/tracked_fit.hpp"

namespace sysid {

/// Writes track.csv, a page and figures into the folder of the output. Exit code 1: a parameter or the noise has changed, or the
/// filter had to begin again.
ExitCode track(Session& session, TrackOptions const& options);

}  // namespace sysid
