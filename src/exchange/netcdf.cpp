// NetCDF's C interface, in memory: the caller writes the file as a whole.
#include "exchange/netcdf.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>

#include "core/text/diagnostic.hpp"
#include "data/format/record_libraries.hpp"
#include "exchange/refused.hpp"

namespace sysid {
namespace {

constexpr std::size_t longest_shown = 60;

void require(int status, std::string_view doing) {
  if (status == NC_ENOMEM) throw std::bad_alloc();
  // Names are the user's, or those of a folder that somebody has changed.
  if (status == NC_EBADNAME || status == NC_EMAXNAME || status == NC_ENAMEINUSE)
    throw refused(
        fmt::format("NetCDF does not allow a variable named `{}`: {}", doing.substr(0, longest_shown), netcdf().strerror(status)),
        "rename it in the model and run the task again");
  if (status != NC_NOERR) throw InternalError(fmt::format("NetCDF, {}: {}", doing, netcdf().strerror(status)));
}

std::size_t size_of(NetcdfVariable const& variable) {
  return std::visit([](auto const& values) { return values.size(); }, variable.values);
}

// A name of NetCDF holds no slash and begins with a letter, a digit or an underscore.
std::string netcdf_name(std::string name) {
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
}

void put_attributes(int group, int variable, Attributes const& attributes) {
  for (auto const& [name, value] : attributes)
    require(netcdf().put_att_text(group, variable, netcdf_name(name).c_str(), value.size(), value.c_str()), name);
}

void put_values(int group, int id, NetcdfVariable const& variable) {
  if (size_of(variable) == 0) return;
  if (auto const* reals = std::get_if<std::vector<double>>(&variable.values)) {
    require(netcdf().put_var_double(group, id, reals->data()), variable.name);
  } else if (auto const* integers = std::get_if<std::vector<std::int64_t>>(&variable.values)) {
    std::vector<long long> const wide(integers->begin(), integers->end());
    require(netcdf().put_var_longlong(group, id, wide.data()), variable.name);
  } else {
    std::vector<char const*> texts;
    for (std::string const& text : std::get<std::vector<std::string>>(variable.values)) texts.push_back(text.c_str());
    require(netcdf().put_var_string(group, id, texts.data()), variable.name);
  }
}

int define(int group, NetcdfVariable const& variable, std::vector<std::pair<std::string, int>> const& known) {
  std::vector<int> dimensions;
  for (std::string const& name : variable.dimensions)
    dimensions.push_back(std::find_if(known.begin(), known.end(), [&](auto const& each) { return each.first == name; })->second);
  int const type = std::holds_alternative<std::vector<double>>(variable.values)         ? NC_DOUBLE
                   : std::holds_alternative<std::vector<std::int64_t>>(variable.values) ? NC_INT64
                                                                                        : NC_STRING;
  int id = 0;
  require(netcdf().def_var(group, netcdf_name(variable.name).c_str(), type, static_cast<int>(dimensions.size()), dimensions.data(),
                           &id),
          variable.name);
  // Chains that stay where they are repeat their numbers; fast, since the rest hardly gets smaller.
  if (!dimensions.empty() && type != NC_STRING) require(netcdf().def_var_deflate(group, id, 1, 1, 1), variable.name);
  put_attributes(group, id, variable.attributes);
  return id;
}

void put_group(int file, NetcdfGroup const& group) {
  int id = 0;
  require(netcdf().def_grp(file, group.name().c_str(), &id), group.name());
  put_attributes(id, NC_GLOBAL, group.attributes());
  std::vector<std::pair<std::string, int>> dimensions;
  for (auto const& [name, size] : group.dimensions()) {
    dimensions.emplace_back(name, 0);
    require(netcdf().def_dim(id, netcdf_name(name).c_str(), size, &dimensions.back().second), name);
  }
  for (NetcdfVariable const& variable : group.variables()) put_values(id, define(id, variable, dimensions), variable);
}

}  // namespace

bool NetcdfGroup::has_dimension(std::string const& name) const {
  return std::any_of(dimensions_.begin(), dimensions_.end(), [&](auto const& each) { return each.first == name; });
}

void NetcdfGroup::add_dimension(NetcdfVariable coordinates) {
  for (auto const& [name, size] : dimensions_)
    if (name == coordinates.name) {
      if (size != size_of(coordinates)) throw InternalError("two sizes of the dimension " + name);
      return;
    }
  if (!taken_.insert(coordinates.name).second) throw InternalError("a variable has the name of the dimension " + coordinates.name);
  dimensions_.emplace_back(coordinates.name, size_of(coordinates));
  coordinates.dimensions = {coordinates.name};
  variables_.push_back(std::move(coordinates));
}

std::string NetcdfGroup::add(NetcdfVariable variable) {
  std::size_t size = 1;
  for (std::string const& name : variable.dimensions) {
    auto const place = std::find_if(dimensions_.begin(), dimensions_.end(), [&](auto const& each) { return each.first == name; });
    if (place == dimensions_.end()) throw InternalError("no dimension " + name);
    size *= place->second;
  }
  if (size != size_of(variable)) throw InternalError("dimensions and values of " + variable.name + " do not agree");
  std::string const wanted = variable.name;
  while (!taken_.insert(variable.name).second) variable.name += '_';
  if (variable.name != wanted) variable.attributes.emplace_back("long_name", wanted);
  variables_.push_back(std::move(variable));
  return variables_.back().name;
}

std::string netcdf_bytes(Attributes const& attributes, std::vector<NetcdfGroup> const& groups) {
  int file = 0;
  require(netcdf().create_mem("sysid", NC_NETCDF4, 1 << 20, &file), "creating");
  NC_memio memory{};
  try {
    put_attributes(file, NC_GLOBAL, attributes);
    for (NetcdfGroup const& group : groups) put_group(file, group);
  } catch (...) {
    netcdf().abort(file);
    throw;
  }
  require(netcdf().close_memio(file, &memory), "closing");
  std::string bytes(static_cast<char const*>(memory.memory), memory.size);
  std::free(memory.memory);
  return bytes;
}

}  // namespace sysid
