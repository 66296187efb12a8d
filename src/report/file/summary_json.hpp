// summary.json and timing.json: strict JSON (what is not finite is null), keys in a fixed order.
#pragma once
#include <string>

#include "report/file/stored_files.hpp"
#include "result/report.hpp"

namespace sysid {

/// Parameters, verdict, fit, modes, ledger, seed, versions, data and settings: the same bytes for the same seed. files: those
/// beside it that are read back.
std::string summary_json(Report const& report, FileDigests const& files = {});

/// Times and facts of the host, kept apart.
std::string timing_json(Report const& report);

}  // namespace sysid
