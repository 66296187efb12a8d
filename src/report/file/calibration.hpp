// What a calibration adds to a result's folder: its part of summary.json, and ranks.csv.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace sysid {

struct CalibrationReport;
struct Report;

nlohmann::ordered_json calibration_json(CalibrationReport const& calibration);

/// One row for each replication: its seed, what its fit came to, and of each quantity the true value, its rank, the share of draws
/// below it, and mean and sd of the posterior; empty cells where there are no draws.
std::string ranks_csv(Report const& report);

}  // namespace sysid
