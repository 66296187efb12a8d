// The module that is linked to the libraries; see data/format/record_libraries.hpp.
#include "data/format/record_libraries.hpp"

namespace {

constexpr sysid::RecordLibraries libraries{
    .version = SYSID_VERSION,
    .netcdf = {.abort = &::nc_abort,
               .close = &::nc_close,
               .close_memio = &::nc_close_memio,
               .create_mem = &::nc_create_mem,
               .def_dim = &::nc_def_dim,
               .def_grp = &::nc_def_grp,
               .def_var = &::nc_def_var,
               .def_var_deflate = &::nc_def_var_deflate,
               .free_string = &::nc_free_string,
               .get_att_double = &::nc_get_att_double,
               .get_att_string = &::nc_get_att_string,
               .get_att_text = &::nc_get_att_text,
               .get_var_double = &::nc_get_var_double,
               .inq_att = &::nc_inq_att,
               .inq_attlen = &::nc_inq_attlen,
               .inq_atttype = &::nc_inq_atttype,
               .inq_dimlen = &::nc_inq_dimlen,
               .inq_format = &::nc_inq_format,
               .inq_grpname = &::nc_inq_grpname,
               .inq_grps = &::nc_inq_grps,
               .inq_vardimid = &::nc_inq_vardimid,
               .inq_varids = &::nc_inq_varids,
               .inq_varname = &::nc_inq_varname,
               .inq_varndims = &::nc_inq_varndims,
               .inq_vartype = &::nc_inq_vartype,
               .open = &::nc_open,
               .put_att_text = &::nc_put_att_text,
               .put_var_double = &::nc_put_var_double,
               .put_var_longlong = &::nc_put_var_longlong,
               .put_var_string = &::nc_put_var_string,
               .strerror = &::nc_strerror},
    .matio = {.close = &::Mat_Close,
              .open = &::Mat_Open,
              .var_free = &::Mat_VarFree,
              .var_get_number_of_fields = &::Mat_VarGetNumberOfFields,
              .var_get_struct_field_by_index = &::Mat_VarGetStructFieldByIndex,
              .var_get_struct_field_by_name = &::Mat_VarGetStructFieldByName,
              .var_get_struct_fieldnames = &::Mat_VarGetStructFieldnames,
              .var_read = &::Mat_VarRead,
              .var_read_next_info = &::Mat_VarReadNextInfo},
};

}  // namespace

extern "C" __attribute__((visibility("default"))) sysid::RecordLibraries const* sysid_record_libraries() { return &libraries; }
