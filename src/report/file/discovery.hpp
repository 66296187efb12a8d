// What a discovery of equations adds to a report: its tables, its part of summary.json, its files.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace sysid {

struct DiscoveryReport;
struct Report;
struct ReportTable;

std::vector<ReportTable> discovery_tables(DiscoveryReport const& discovery);
nlohmann::ordered_json discovery_json(DiscoveryReport const& discovery);
/// File names and contents: terms.csv, found.sysid, and those of `validation_files`.
std::vector<std::pair<std::string, std::string>> discovery_files(Report const& report);

}  // namespace sysid
