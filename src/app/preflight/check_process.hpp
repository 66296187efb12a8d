// The checks of Gaussian processes at samples before a fit: their priors against the data.
#pragma once
#include "app/session/session.hpp"
#include "experiment/experiments.hpp"
#include "result/check_page.hpp"

namespace sysid {

/// Draws of the prior against the sd of what is measured and against range and spacing of the processes' inputs, and what one
/// likelihood takes, onto the page. Every prior can be drawn from.
void preflight_processes(Session& session, FitTask const& what, std::vector<ExperimentData> const& data, PreflightPage& page);

}  // namespace sysid
