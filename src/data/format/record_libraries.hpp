// The libraries of NetCDF, HDF5 and MATLAB files: they bring forty others (transport, certificates, compression), which take half
// of the time that the program needs to start, so a module of its own is linked to them and opened when such a file is read or
// written.
#pragma once
#include <matio.h>
#include <netcdf.h>
#include <netcdf_mem.h>

namespace sysid {

/// Functions of the netCDF library, by their names there without `nc_`.
struct NetcdfFunctions {
  decltype(&::nc_abort) abort;
  decltype(&::nc_close) close;
  decltype(&::nc_close_memio) close_memio;
  decltype(&::nc_create_mem) create_mem;
  decltype(&::nc_def_dim) def_dim;
  decltype(&::nc_def_grp) def_grp;
  decltype(&::nc_def_var) def_var;
  decltype(&::nc_def_var_deflate) def_var_deflate;
  decltype(&::nc_free_string) free_string;
  decltype(&::nc_get_att_double) get_att_double;
  decltype(&::nc_get_att_string) get_att_string;
  decltype(&::nc_get_att_text) get_att_text;
  decltype(&::nc_get_var_double) get_var_double;
  decltype(&::nc_inq_att) inq_att;
  decltype(&::nc_inq_attlen) inq_attlen;
  decltype(&::nc_inq_atttype) inq_atttype;
  decltype(&::nc_inq_dimlen) inq_dimlen;
  decltype(&::nc_inq_format) inq_format;
  decltype(&::nc_inq_grpname) inq_grpname;
  decltype(&::nc_inq_grps) inq_grps;
  decltype(&::nc_inq_vardimid) inq_vardimid;
  decltype(&::nc_inq_varids) inq_varids;
  decltype(&::nc_inq_varname) inq_varname;
  decltype(&::nc_inq_varndims) inq_varndims;
  decltype(&::nc_inq_vartype) inq_vartype;
  decltype(&::nc_open) open;
  decltype(&::nc_put_att_text) put_att_text;
  decltype(&::nc_put_var_double) put_var_double;
  decltype(&::nc_put_var_longlong) put_var_longlong;
  decltype(&::nc_put_var_string) put_var_string;
  decltype(&::nc_strerror) strerror;
};

/// Functions of matio, by their names there without `Mat_`.
struct MatioFunctions {
  decltype(&::Mat_Close) close;
  decltype(&::Mat_Open) open;
  decltype(&::Mat_VarFree) var_free;
  decltype(&::Mat_VarGetNumberOfFields) var_get_number_of_fields;
  decltype(&::Mat_VarGetStructFieldByIndex) var_get_struct_field_by_index;
  decltype(&::Mat_VarGetStructFieldByName) var_get_struct_field_by_name;
  decltype(&::Mat_VarGetStructFieldnames) var_get_struct_fieldnames;
  decltype(&::Mat_VarRead) var_read;
  decltype(&::Mat_VarReadNextInfo) var_read_next_info;
};

/// Opens the module at the first call of any of these; InternalError where it cannot be opened, since it is installed with the
/// program. May be called from several threads.
NetcdfFunctions const& netcdf();
MatioFunctions const& matio();
void open_record_libraries();

/// What the module holds.
struct RecordLibraries {
  char const* version;
  NetcdfFunctions netcdf;
  MatioFunctions matio;
};
using RecordLibrariesEntry = RecordLibraries const* (*)();
inline constexpr char const* record_libraries_entry = "sysid_record_libraries";

}  // namespace sysid
