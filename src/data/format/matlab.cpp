// By matio. What it makes of a forged file may be anything: it is called in a process of its own.
#include "data/format/matlab.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <set>
#include <stdexcept>

#include "data/format/hdf5_links.hpp"
#include "data/format/matlab4.hpp"
#include "data/format/matlab_elements.hpp"
#include "data/format/record_libraries.hpp"
#include "data/table/record_bytes.hpp"

namespace sysid {
namespace {

struct Closes {
  void operator()(mat_t* file) const { matio().close(file); }
  void operator()(matvar_t* variable) const { matio().var_free(variable); }
};
using MatFile = std::unique_ptr<mat_t, Closes>;
using Read = std::unique_ptr<matvar_t, Closes>;

constexpr int deepest = 16;  // structs in structs

MatFile opened(std::string const& path) {
  MatFile file(matio().open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) throw std::runtime_error("no MATLAB file");
  return file;
}

/// With the names of what it holds, as they are written in MATLAB.
std::string array_of_structs(matvar_t const& variable, std::string const& path) {
  std::string size;
  for (int d = 0; d < variable.rank; ++d) size += (d == 0 ? "" : " x ") + std::to_string(variable.dims[d]);
  auto const* const names = matio().var_get_struct_fieldnames(&variable);
  bool const has_fields = matio().var_get_number_of_fields(const_cast<matvar_t*>(&variable)) > 0 && names != nullptr;
  if (size.starts_with("0") || size.ends_with(" 0") || !has_fields) return fmt::format("is an empty {} array of structs", size);
  return fmt::format("is a {0} array of structs: save what is in it as vectors, such as `{1}_1 = {2}(1).{1}`", size, names[0],
                     path);
}

std::string complex_refusal(std::string const& path) {
  std::string name = path;
  std::replace(name.begin(), name.end(), '.', '_');
  return fmt::format("is complex: save its parts as variables of their own, `{0}_re = real({1})` and `{0}_im = imag({1})`", name,
                     path);
}

std::string matlab_refusal(matvar_t const& variable, std::string const& path) {
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
    case MAT_C_SINGLE:
    case MAT_C_INT8:
    case MAT_C_UINT8:
    case MAT_C_INT16:
    case MAT_C_UINT16:
    case MAT_C_INT32:
    case MAT_C_UINT32:
    case MAT_C_INT64:
    case MAT_C_UINT64:
      return variable.isComplex ? complex_refusal(path) : "";
    case MAT_C_CHAR:
      return "is text";
    case MAT_C_SPARSE:
      return "is a sparse matrix: save it with `full`";
    case MAT_C_CELL:
      return "is a cell array: save it with `cell2mat`";
    case MAT_C_STRUCT:
      return array_of_structs(variable, path);
    default:
      return "is an object, such as a table or a time series: save its columns as vectors";
  }
}

void describe(matvar_t* variable, std::string const& path, int depth, std::vector<Variable>& all) {
  if (variable == nullptr) return;
  Variable made{path, {}, matlab_refusal(*variable, path), {}};
  for (int d = 0; d < variable->rank; ++d) made.size.push_back(variable->dims[d]);
  bool const single = variable->rank == 2 && variable->dims[0] == 1 && variable->dims[1] == 1;
  if (variable->class_type != MAT_C_STRUCT || !single || depth > deepest) {
    all.push_back(std::move(made));
    return;
  }
  unsigned const fields = matio().var_get_number_of_fields(variable);
  char* const* const names = matio().var_get_struct_fieldnames(variable);
  for (unsigned f = 0; f < fields && names != nullptr; ++f)
    describe(matio().var_get_struct_field_by_index(variable, f, 0), fmt::format("{}.{}", path, names[f]), depth + 1, all);
}

/// Of versions 4 to 7; the library of version 7.3, HDF5, looks itself.
void check_elements(std::string const& path) {
  std::string const bytes = read_record_bytes(path);
  if (is_matlab4(bytes)) {
    if (!matlab4_is_whole(bytes)) throw std::runtime_error("cut or damaged");
    return;
  }
  bool const older = bytes.size() > 125 && (bytes[124] == 1 || bytes[125] == 1);
  if (older && !matlab_elements_are_whole(bytes)) throw std::runtime_error("cut or damaged");
}

/// Other programs than MATLAB write structs of version 7.3 without the list of their fields, and the library then finds none or a
/// part of them. Each object of such a file has its class as an attribute.
void tell_unlisted(std::string const& path, std::vector<Variable>& all) {
  std::string const bytes = read_record_bytes(path);
  bool const by_hdf5 = bytes.size() > 125 && (bytes[124] == 2 || bytes[125] == 2);
  if (!by_hdf5 || bytes.find("MATLAB_fields") != std::string::npos || bytes.find("#refs#") != std::string::npos) return;
  std::size_t objects = 0;
  for (std::size_t at = bytes.find("MATLAB_class"); at != std::string::npos; at = bytes.find("MATLAB_class", at + 1)) ++objects;
  std::set<std::string> listed;  // and the structs around them
  for (Variable const& each : all) {
    listed.insert(each.path);
    for (std::size_t dot = each.path.find('.'); dot != std::string::npos; dot = each.path.find('.', dot + 1))
      listed.insert(each.path.substr(0, dot));
  }
  if (!all.empty() && objects <= listed.size()) return;
  all.push_back({all.empty() ? "variables" : "structs",
                 {},
                 "cannot all be found, as another program than MATLAB wrote this file: save the columns as vectors outside of "
                 "structs, or as an HDF5 file (`.h5`) without the header of MATLAB",
                 {}});
}

std::vector<Variable> list_matlab(std::string const& path) {
  check_elements(path);
  std::vector<Variable> all;
  {  // one file at a time is open in this process
    MatFile const file = opened(path);
    while (Read const variable{matio().var_read_next_info(file.get())})
      if (variable->name != nullptr) describe(variable.get(), variable->name, 0, all);
  }
  tell_unlisted(path, all);
  return all;
}

template <class Number>
std::vector<double> as_doubles(matvar_t const& variable, std::size_t count) {
  if (variable.data == nullptr || variable.nbytes < count * sizeof(Number)) throw std::runtime_error("no data");
  auto const* const numbers = static_cast<Number const*>(variable.data);
  return {numbers, numbers + count};
}

std::vector<double> numbers_of(matvar_t const& variable) {
  std::size_t count = 1;
  for (int d = 0; d < variable.rank; ++d) count *= variable.dims[d];
  if (count == 0) return {};
  if (variable.isComplex) throw std::runtime_error("complex");
  switch (variable.class_type) {
    case MAT_C_DOUBLE:
      return as_doubles<double>(variable, count);
    case MAT_C_SINGLE:
      return as_doubles<float>(variable, count);
    case MAT_C_INT8:
      return as_doubles<mat_int8_t>(variable, count);
    case MAT_C_UINT8:
      return as_doubles<mat_uint8_t>(variable, count);
    case MAT_C_INT16:
      return as_doubles<mat_int16_t>(variable, count);
    case MAT_C_UINT16:
      return as_doubles<mat_uint16_t>(variable, count);
    case MAT_C_INT32:
      return as_doubles<mat_int32_t>(variable, count);
    case MAT_C_UINT32:
      return as_doubles<mat_uint32_t>(variable, count);
    case MAT_C_INT64:
      return as_doubles<mat_int64_t>(variable, count);
    case MAT_C_UINT64:
      return as_doubles<mat_uint64_t>(variable, count);
    default:
      throw std::runtime_error("no numbers");
  }
}

std::vector<double> read_matlab(std::string const& path, std::string const& name) {
  MatFile const file = opened(path);
  std::size_t dot = name.find('.');
  Read const top{matio().var_read(file.get(), name.substr(0, dot).c_str())};
  matvar_t* variable = top.get();
  while (variable != nullptr && dot != std::string::npos) {
    std::size_t const next = name.find('.', dot + 1);
    variable = matio().var_get_struct_field_by_name(variable, name.substr(dot + 1, next - dot - 1).c_str(), 0);
    dot = next;
  }
  if (variable == nullptr) throw std::runtime_error("no such variable");
  std::vector<double> const by_columns = numbers_of(*variable);
  if (variable->rank != 2) return by_columns;
  std::size_t const rows = variable->dims[0], columns = variable->dims[1];
  std::vector<double> by_rows(by_columns.size());
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t c = 0; c < columns; ++c) by_rows[r * columns + c] = by_columns[c * rows + r];
  return by_rows;
}

}  // namespace

bool is_matlab(std::string_view bytes) {
  if (is_matlab4(bytes)) return true;
  if (bytes.size() < 128 || !bytes.starts_with("MATLAB")) return false;
  std::string_view const end = bytes.substr(124, 4);
  return end == std::string_view("\0\1IM", 4) || end == std::string_view("\1\0MI", 4) || end == std::string_view("\0\2IM", 4) ||
         end == std::string_view("\2\0MI", 4);
}

VariableFormat const matlab_format{"MATLAB file", &list_matlab, &read_matlab, &external_link_in};

}  // namespace sysid
