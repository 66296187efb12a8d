// `fit`: one flow for every kind of likelihood.
#pragma once
#include "app/session/session.hpp"

namespace sysid {

ExitCode run_fit(Session& session, int index, Task const& task, FitTask const& what);

}  // namespace sysid
