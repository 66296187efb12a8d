// Fits as Stan programs in their folders of results.
#pragma once
#include <ostream>

#include "exchange/results_folder.hpp"

namespace sysid {

/// Writes fits as TASK.stan and TASK.data.json into their folders of results and says on `out` which. With results: those fits,
/// with the solver that was chosen for them; without (null): all fits of the session's file, with the solver that they state. Fits
/// that cannot be written are left out; returned is why, with their places. UserError where there is no fit, and where a file is
/// there already and `force` is not given: then nothing is written.
Diagnostics export_stan(Session& session, ResultsFolder const* results, bool force, std::ostream& out);

}  // namespace sysid
