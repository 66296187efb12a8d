// The tasks: one function for each verb; `fit`, `select` and its predictions have rooms of their own.
#pragma once
#include "app/fit/fit.hpp"
#include "app/session/session.hpp"

namespace sysid {

ExitCode run_simulate(Session& session, Task const& task, SimulateTask const& what);
ExitCode run_discover(Session& session, Task const& task, DiscoverTask const& what);
ExitCode run_predict(Session& session, Task const& task, PredictTask const& what);

}  // namespace sysid
