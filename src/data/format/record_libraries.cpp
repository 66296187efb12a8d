#include "data/format/record_libraries.hpp"

#include "core/system/module.hpp"
#include "core/text/diagnostic.hpp"

namespace sysid {
namespace {

RecordLibraries const& opened_libraries() {
  static auto const once = open_module<RecordLibraries>("sysid_records.so", record_libraries_entry);
  if (once.table == nullptr) throw InternalError("no libraries for NetCDF and MATLAB files: " + once.why);
  return *once.table;
}

}  // namespace

void open_record_libraries() { opened_libraries(); }
NetcdfFunctions const& netcdf() { return opened_libraries().netcdf; }
MatioFunctions const& matio() { return opened_libraries().matio; }

}  // namespace sysid
