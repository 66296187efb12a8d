// The result as a page of plain text for stdout.
#pragma once
#include <string>

#include "result/report.hpp"

namespace sysid {

/// What was done, the summary table, further tables, fit, failures and the verdict in plain words. read_at: for what the
/// verdict says is to be typed.
std::string terminal_summary(Report const& report, Surface read_at = Surface::command_line);

}  // namespace sysid
