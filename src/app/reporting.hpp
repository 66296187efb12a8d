// What reports of all tasks share: model text, equations, priors, versions.
#pragma once
#include "app/session.hpp"
#include "report/report.hpp"

namespace sysid {

/// A report with everything known before the task has run.
Report begin_report(Session const& session, Task const& task, int model, std::string what, std::uint64_t seed);

}  // namespace sysid
