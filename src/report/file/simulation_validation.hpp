// Tables, JSON and files of the validation of discovered structures by simulation.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace sysid {

struct ValidationReport;
struct Report;
struct ReportTable;

std::vector<ReportTable> validation_tables(ValidationReport const& validation);
nlohmann::ordered_json validation_json(ValidationReport const& validation);
/// structures.csv and refit.csv.
std::vector<std::pair<std::string, std::string>> validation_files(Report const& report, ValidationReport const& validation);

}  // namespace sysid
