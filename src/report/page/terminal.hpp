// The result as a page of plain text for stdout.
#pragma once
#include <string>

#include "result/report.hpp"

namespace sysid {

/// What was done, the summary table, further tables, fit, failures and the verdict in plain words.
std::string terminal_summary(Report const& report);

}  // namespace sysid
