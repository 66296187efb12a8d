// Tables, JSON and files of the validation of discovered structures by simulation.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

namespace sysid {

struct JudgedReport;
struct Report;
struct ReportTable;

std::vector<ReportTable> judged_tables(JudgedReport const& judged);
nlohmann::ordered_json judged_json(JudgedReport const& judged);
/// structures.csv and refit.csv.
std::vector<std::pair<std::string, std::string>> judged_files(Report const& report, JudgedReport const& judged);

}  // namespace sysid
