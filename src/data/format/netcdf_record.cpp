// By the netCDF library, in a process of its own.
#include "data/format/netcdf_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "data/format/hdf5_links.hpp"
#include "data/format/record_libraries.hpp"

namespace sysid {
namespace {

struct NetcdfFile {
  int id = -1;
  explicit NetcdfFile(std::string const& path) {
    if (netcdf().open(path.c_str(), NC_NOWRITE, &id) != NC_NOERR) throw std::runtime_error("no NetCDF file");
  }
  ~NetcdfFile() { netcdf().close(id); }
  NetcdfFile(NetcdfFile const&) = delete;
};

std::string name_of_group(int group) {
  char name[NC_MAX_NAME + 1] = "";
  netcdf().inq_grpname(group, name);
  return name;
}

std::string text_attribute(int group, int variable, char const* name) {
  nc_type type = 0;
  std::size_t length = 0;
  if (netcdf().inq_att(group, variable, name, &type, &length) != NC_NOERR || length == 0 || length > 1000) return {};
  if (type == NC_CHAR) {
    std::string text(length, '\0');
    return netcdf().get_att_text(group, variable, name, text.data()) == NC_NOERR ? text.substr(0, text.find('\0')) : std::string();
  }
  if (type != NC_STRING || length != 1) return {};
  char* read = nullptr;
  if (netcdf().get_att_string(group, variable, name, &read) != NC_NOERR || read == nullptr) return {};
  std::string text(read);
  netcdf().free_string(1, &read);
  return text;
}

std::optional<double> number_attribute(int group, int variable, char const* name) {
  nc_type type = 0;
  std::size_t length = 0;
  double value = 0;
  if (netcdf().inq_att(group, variable, name, &type, &length) != NC_NOERR || length != 1 || type == NC_CHAR || type == NC_STRING)
    return std::nullopt;
  return netcdf().get_att_double(group, variable, name, &value) == NC_NOERR ? std::optional(value) : std::nullopt;
}

/// Several numbers, as `valid_range` is; empty where there are none.
std::vector<double> numbers_attribute(int group, int variable, char const* name) {
  nc_type type = 0;
  std::size_t length = 0;
  if (netcdf().inq_att(group, variable, name, &type, &length) != NC_NOERR || length > 1000 || type == NC_CHAR || type == NC_STRING)
    return {};
  std::vector<double> values(length);
  if (length == 0 || netcdf().get_att_double(group, variable, name, values.data()) != NC_NOERR) return {};
  return values;
}

/// What `scale_factor` and the like must not be.
std::string attribute_refusal(int group, int variable) {
  for (char const* const name : {"scale_factor", "add_offset", "valid_range", "valid_min", "valid_max"}) {
    std::size_t const wanted = std::string_view(name) == "valid_range" ? 2 : 1;
    nc_type type = 0;
    std::size_t length = 0;
    if (netcdf().inq_att(group, variable, name, &type, &length) != NC_NOERR) continue;
    if (numbers_attribute(group, variable, name).size() != wanted)
      return std::string("has a `") + name + "` that is " + (wanted == 1 ? "no number" : "no pair of numbers");
  }
  return {};
}

/// What CF says of integers that are stored with a sign and have none: 2 to the number of their bits.
double unsigned_wrap(int group, int variable, nc_type type) {
  std::string const text = text_attribute(group, variable, "_Unsigned");
  if (text != "true" && text != "TRUE" && text != "True") return 0;
  return type == NC_BYTE ? 256.0 : type == NC_SHORT ? 65536.0 : type == NC_INT ? 4294967296.0 : 0;
}

/// Calls visit(path, group, variable) for each variable, until it returns false.
template <class Visit>
bool each_variable(int group, std::string const& prefix, int depth, Visit const& visit) {
  int count = 0;
  netcdf().inq_varids(group, &count, nullptr);
  std::vector<int> ids(static_cast<std::size_t>(std::max(count, 0)));
  if (!ids.empty()) netcdf().inq_varids(group, &count, ids.data());
  for (int const id : ids) {
    char name[NC_MAX_NAME + 1] = "";
    if (netcdf().inq_varname(group, id, name) == NC_NOERR && !visit(prefix + name, group, id)) return false;
  }
  int groups = 0;
  if (depth > 16 || netcdf().inq_grps(group, &groups, nullptr) != NC_NOERR || groups <= 0) return true;
  std::vector<int> inner(static_cast<std::size_t>(groups));
  netcdf().inq_grps(group, &groups, inner.data());
  for (int const each : inner)
    if (!each_variable(each, prefix + name_of_group(each) + "/", depth + 1, visit)) return false;
  return true;
}

std::vector<std::size_t> size_of(int group, int variable) {
  int dimensions = 0;
  if (netcdf().inq_varndims(group, variable, &dimensions) != NC_NOERR || dimensions < 0 || dimensions > NC_MAX_VAR_DIMS)
    throw std::runtime_error("no dimensions");
  std::vector<int> ids(static_cast<std::size_t>(dimensions));
  if (!ids.empty() && netcdf().inq_vardimid(group, variable, ids.data()) != NC_NOERR) throw std::runtime_error("no dimensions");
  std::vector<std::size_t> size(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (netcdf().inq_dimlen(group, ids[i], &size[i]) != NC_NOERR) throw std::runtime_error("no length");
  return size;
}

std::string netcdf_refusal(nc_type type) {
  if (type == NC_CHAR || type == NC_STRING) return "is text";
  if (type < NC_BYTE || type > NC_UINT64) return "has numbers of a user-defined type, such as complex numbers or rows of a table";
  return {};
}

std::vector<Variable> list_netcdf(std::string const& path) {
  NetcdfFile const file(path);
  std::vector<Variable> all;
  each_variable(file.id, "", 0, [&](std::string const& name, int group, int variable) {
    nc_type type = 0;
    if (netcdf().inq_vartype(group, variable, &type) != NC_NOERR) throw std::runtime_error("no type");
    std::string refused = netcdf_refusal(type);
    if (refused.empty()) refused = attribute_refusal(group, variable);
    all.push_back({name, size_of(group, variable), std::move(refused), text_attribute(group, variable, "units")});
    return true;
  });
  return all;
}

/// Whether the NetCDF library wrote the file. HDF5 files of other programs have no numbers that it fills in.
bool by_netcdf(int file) {
  int format = 0;
  std::size_t length = 0;
  return netcdf().inq_format(file, &format) == NC_NOERR &&
         ((format != NC_FORMAT_NETCDF4 && format != NC_FORMAT_NETCDF4_CLASSIC) ||
          netcdf().inq_attlen(file, NC_GLOBAL, "_NCProperties", &length) == NC_NOERR);
}

/// A number of an attribute as the variable's type holds it: 1e20 as a float is another double than 1e20.
double as_stored(double number, nc_type type) {
  return type == NC_FLOAT ? static_cast<double>(static_cast<float>(number)) : number;
}

/// What unwritten numbers of a type are, where the file does not say.
std::optional<double> usual_fill(nc_type type) {
  switch (type) {
    case NC_SHORT:
      return NC_FILL_SHORT;
    case NC_USHORT:
      return NC_FILL_USHORT;
    case NC_INT:
      return NC_FILL_INT;
    case NC_UINT:
      return NC_FILL_UINT;
    case NC_INT64:
      return static_cast<double>(NC_FILL_INT64);
    case NC_UINT64:
      return static_cast<double>(NC_FILL_UINT64);
    case NC_FLOAT:
      return static_cast<double>(NC_FILL_FLOAT);
    case NC_DOUBLE:
      return NC_FILL_DOUBLE;
    default:
      return std::nullopt;
  }
}

/// `valid_range`, `valid_min` and `valid_max`: of the numbers as stored, but of the scaled ones where stored ones are integers and
/// the bound is not.
struct ValidRange {
  struct Bound {
    double at;
    bool scaled = false;
  };
  Bound least{-std::numeric_limits<double>::infinity()}, most{std::numeric_limits<double>::infinity()};

  ValidRange(int group, int variable, nc_type type, double wrap) {
    auto const bound = [&](char const* name, std::size_t index, Bound& to) {
      std::vector<double> const values = numbers_attribute(group, variable, name);
      if (values.size() <= index) return;
      nc_type stored = 0;
      netcdf().inq_atttype(group, variable, name, &stored);
      bool const real = stored == NC_FLOAT || stored == NC_DOUBLE;
      bool const scaled = real && type != NC_FLOAT && type != NC_DOUBLE;
      to = {values[index] < 0 && !scaled ? values[index] + wrap : as_stored(values[index], type), scaled};
    };
    bound("valid_min", 0, least);
    bound("valid_max", 0, most);
    bound("valid_range", 0, least);
    bound("valid_range", 1, most);
  }
  bool has(double stored, double value) const {
    return !((least.scaled ? value : stored) < least.at) && !((most.scaled ? value : stored) > most.at);
  }
};

std::vector<double> numbers_of(int file, int group, int variable) {
  nc_type type = 0;
  if (netcdf().inq_vartype(group, variable, &type) != NC_NOERR || !netcdf_refusal(type).empty())
    throw std::runtime_error("no numbers");
  std::size_t count = 1;
  for (std::size_t const each : size_of(group, variable)) count *= each;
  std::vector<double> values(count);
  if (count > 0 && netcdf().get_var_double(group, variable, values.data()) != NC_NOERR) throw std::runtime_error("no data");
  auto fill = number_attribute(group, variable, "_FillValue");
  if (!fill && by_netcdf(file)) fill = usual_fill(type);
  std::vector<double> missing = numbers_attribute(group, variable, "missing_value");
  for (double& each : missing) each = as_stored(each, type);
  double const scale = number_attribute(group, variable, "scale_factor").value_or(1);
  double const offset = number_attribute(group, variable, "add_offset").value_or(0);
  double const wrap = unsigned_wrap(group, variable, type);
  ValidRange const valid(group, variable, type, wrap);
  for (double& value : values) {
    bool const absent = (fill && value == *fill) || std::find(missing.begin(), missing.end(), value) != missing.end();
    double const stored = value < 0 ? value + wrap : value;
    value = stored * scale + offset;
    if (absent || !valid.has(stored, value)) value = std::numeric_limits<double>::quiet_NaN();
  }
  return values;
}

std::vector<double> read_netcdf(std::string const& path, std::string const& name) {
  NetcdfFile const file(path);
  std::optional<std::vector<double>> values;
  each_variable(file.id, "", 0, [&](std::string const& each, int group, int variable) {
    if (each == name) values = numbers_of(file.id, group, variable);
    return !values;
  });
  if (!values) throw std::runtime_error("no such variable");
  return std::move(*values);
}

}  // namespace

bool is_netcdf(std::string_view bytes) {
  return bytes.starts_with("\x89HDF\r\n\x1a\n") || bytes.starts_with(std::string_view("CDF\1", 4)) || bytes.starts_with("CDF\2") ||
         bytes.starts_with("CDF\5");
}

VariableFormat const netcdf_format{"NetCDF or HDF5 file", &list_netcdf, &read_netcdf, &external_link_in};

}  // namespace sysid
