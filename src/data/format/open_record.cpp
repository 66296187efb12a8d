// The table of formats, and files that are known and cannot be read.
#include "data/format/open_record.hpp"

#include "core/system/digest.hpp"
#include "data/format/matlab.hpp"
#include "data/format/netcdf_record.hpp"
#include "data/table/file_errors.hpp"
#include "data/table/gzip.hpp"
#include "data/table/record_bytes.hpp"
#include "data/table/table.hpp"

namespace sysid {
namespace {

/// What people try to read that is no record, by its first bytes.
struct KnownFile {
  std::string_view begins, name, help;
};
constexpr KnownFile known_files[] = {
    {"PK\x03\x04", "a spreadsheet or a zip archive", "save the sheet as CSV, or unpack the archive"},
    {"\xd0\xcf\x11\xe0", "a spreadsheet of old Excel", "save the sheet as CSV"},
    {"BZh91AY&SY", "a bzip2 file", "unpack it; gzip files are read as they are"},
    {"\xfd\x37zXZ", "an xz file", "unpack it; gzip files are read as they are"},
    {"\x28\xb5\x2f\xfd", "a zstd file", "unpack it; gzip files are read as they are"},
    {"PAR1", "a Parquet file", "write it as NetCDF or CSV: `to_csv` of pandas"},
    {"ARROW1", "an Arrow file", "write it as NetCDF or CSV: `to_csv` of pandas"},
    {"\x93NUMPY", "a file of NumPy", "write it as CSV or .mat: `numpy.savetxt`, `scipy.io.savemat`"},
    {"RIFF", "a sound file", "write its samples as CSV or .mat: `scipy.io.wavfile`, `scipy.io.savemat`"},
    {"MDF     ", "an MDF file", "export it as CSV or .mat"},
    {"    -1\n    58", "a universal file (UFF)", "export it as CSV or .mat"},
    {"    -1\r\n    58", "a universal file (UFF)", "export it as CSV or .mat"},
    {"SQLite format 3", "a database of SQLite", "export the table as CSV"},
    {"%PDF", "a PDF document", "get the numbers as CSV"},
    {"<!DOCTYPE html", "a web page", "download the file itself"},
    {"<!doctype html", "a web page", "download the file itself"},
    {"<html", "a web page", "download the file itself"},
    {"{\"", "a JSON file", "write it as CSV"},
    {"[{\"", "a JSON file", "write it as CSV"},
    {"TDSm", "a TDMS file of LabVIEW", "export it as CSV or .lvm"},
};

template <VariableFormat const& format>
std::unique_ptr<RecordFile> open_as(std::string path, std::string const& bytes, std::string digest, ReadingRules const& rules) {
  return open_variables(format, std::move(path), bytes, std::move(digest), rules);
}

constexpr FormatRow format_rows[] = {
    {"MATLAB file", &is_matlab, &open_as<matlab_format>},
    {"NetCDF or HDF5 file", &is_netcdf, &open_as<netcdf_format>},
};

/// What says how text is written.
ReadingRules without_missing(ReadingRules rules) {
  rules.missing.clear();
  rules.asked_for_missing = rules.no_other_mark = false;
  return rules;
}

}  // namespace

std::span<FormatRow const> formats() { return format_rows; }

FormatRow const* format_of(std::string_view bytes) {
  for (FormatRow const& row : formats())
    if (row.recognises(bytes)) return &row;
  return nullptr;
}

std::unique_ptr<RecordFile> open_record(std::string const& path, ReadingRules const& rules, ColumnNeeds const& needs,
                                        std::optional<Span> mention, std::string const& shown_path) {
  std::string const& name = shown_path.empty() ? path : shown_path;
  try {
    std::string bytes = read_record_bytes(path);
    std::string digest = sha256(bytes);
    if (is_gzip(bytes)) bytes = gunzip(name, bytes);
    for (KnownFile const& known : known_files)
      if (bytes.starts_with(known.begins)) throw UserError(data_errors::not_a_record(name, known.name, known.help, mention));
    FormatRow const* const format = format_of(bytes);
    if (format == nullptr) {
      auto table = std::make_unique<Table>(Table::parse(name, std::move(bytes), mention, 0, rules, needs));
      table->set_digest(std::move(digest));
      return table;
    }
    if (without_missing(rules) != ReadingRules{}) throw UserError(data_errors::reading_of_no_text(name, format->name, mention));
    return format->open(name, bytes, std::move(digest), rules);
  } catch (UserError const& error) {
    Diagnostic placed = error.diagnostic();
    if (mention && !placed.primary) placed.primary = Label{*mention, {}};
    throw UserError(std::move(placed));
  }
}

}  // namespace sysid
