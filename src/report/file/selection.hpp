// What a selection among models adds to files and pages: its tables, its part of summary.json, its CSV files.
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace sysid {

struct Report;
struct SelectionReport;
struct SelectionResult;
struct ReportTable;

/// "bouc_wen(n=2)": what each of the candidate models, all of them in their order, is called in names of files.
std::vector<std::string> model_file_names(std::vector<std::string> const& models);
std::vector<std::string> model_file_names(SelectionResult const& selection);

std::vector<ReportTable> selection_tables(SelectionReport const& selection);
/// {NAME: {probability, share, died_in_population, parameters, ...}}.
nlohmann::ordered_json models_json(SelectionReport const& selection);
nlohmann::ordered_json populations_json(SelectionReport const& selection);

/// File names and contents: populations.csv; per model with particles particles_MODEL.csv (weight__, distance__, population__, then
/// parameters) and draws_MODEL.csv (as many particles resampled to equal weights, in the form of Stan's CSV). Of jumping chains
/// draws_MODEL.csv alone.
std::vector<std::pair<std::string, std::string>> selection_files(Report const& report);

}  // namespace sysid
