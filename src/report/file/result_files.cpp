// The tables.
#include "report/file/result_files.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/text/diagnostic.hpp"

namespace sysid {

std::span<ResultFileRow const> result_file_rows() {
  static constexpr ResultFileRow rows[] = {
      {"summary.json"},          {"timing.json"},          {"report.html"},         {"report.cbor"},         {"resolved.sysid"},
      {"resolved_*.sysid"},      {"draws_*.csv", true},    {"predict.csv", true},   {"predict_*.csv", true}, {"states.csv", true},
      {"states_*.csv", true},    {"function_*.csv", true}, {"pointwise.csv", true}, {"ranks.csv", true},     {"populations.csv"},
      {"particles_*.csv", true}, {"polished_*.csv", true}, {"terms.csv"},           {"structures.csv"},      {"refit.csv"},
      {"free_run.csv", true},    {"free_run_*.csv", true}, {"found.sysid"},
  };
  return rows;
}

ResultFileRow const* result_file_row(std::string_view name) {
  auto const rows = result_file_rows();
  auto const found = std::ranges::find_if(rows, [&](ResultFileRow const& row) {
    auto const star = row.name.find('*');
    if (star == row.name.npos) return name == row.name;
    return name.size() + 1 >= row.name.size() && name.starts_with(row.name.substr(0, star)) &&
           name.ends_with(row.name.substr(star + 1));
  });
  return found == rows.end() ? nullptr : &*found;
}

std::string const& known_result_file(std::string const& name) {
  if (result_file_row(name) == nullptr)
    throw InternalError(fmt::format("`{}` is in no row of the files of a result (src/report/file/result_files.cpp)", name));
  return name;
}

std::span<ExportedFileRow const> exported_file_rows() {
  static constexpr ExportedFileRow rows[] = {{".nc", true}, {".stan"}, {".data.json"}};
  return rows;
}

bool is_exported_file(std::string_view name, std::string_view task) {
  if (!name.starts_with(task)) return false;
  std::string_view const behind = name.substr(task.size());
  return std::ranges::any_of(exported_file_rows(), [&](ExportedFileRow const& row) {
    return behind == row.ending || (row.by_model && behind.starts_with("_") && behind.ends_with(row.ending));
  });
}

std::string exported_file(std::string_view task, std::string_view ending, std::string_view model) {
  std::string const name = model.empty() ? fmt::format("{}{}", task, ending) : fmt::format("{}_{}{}", task, model, ending);
  if (!is_exported_file(name, task))
    throw InternalError(fmt::format("`{}` is in no row of the files of exporters (src/report/file/result_files.cpp)", name));
  return name;
}

}  // namespace sysid
