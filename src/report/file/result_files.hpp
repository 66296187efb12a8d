// What the files of a result are called: one table, by which they are written, read back and removed.
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace sysid {

struct ResultFileRow {
  std::string_view name;  // "predict.csv"; with a star for what tells several apart: "draws_*.csv"
  bool sealed = false;    // read back by its columns: the summary holds its digest, and a result without it is damaged
};
std::span<ResultFileRow const> result_file_rows();
/// The row of a name; null for what is no file of a result.
ResultFileRow const* result_file_row(std::string_view name);
/// The name of a file that is about to be written: InternalError where the table does not have it, since it would outlive its
/// result.
std::string const& known_result_file(std::string const& name);

/// What an exporter leaves in the folder of a result, which belongs to that result.
struct ExportedFileRow {
  std::string_view ending;  // ".nc" of TASK.nc
  bool by_model = false;    // also TASK_MODEL.nc
};
std::span<ExportedFileRow const> exported_file_rows();
bool is_exported_file(std::string_view name, std::string_view task);
/// TASK.nc, of a candidate model TASK_MODEL.nc. InternalError for an ending that is not in the table.
std::string exported_file(std::string_view task, std::string_view ending, std::string_view model = {});

}  // namespace sysid
