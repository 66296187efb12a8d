// Named arrays in groups, written as NetCDF-4. Records are read with netCDF in data/format.
#pragma once
#include <cstdint>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace sysid {

/// Names and texts, in order.
using Attributes = std::vector<std::pair<std::string, std::string>>;

/// An array by rows over named dimensions of its group; none: a single value.
struct NetcdfVariable {
  std::string name;
  std::vector<std::string> dimensions;
  std::variant<std::vector<double>, std::vector<std::int64_t>, std::vector<std::string>> values;
  Attributes attributes;
};

class NetcdfGroup {
 public:
  explicit NetcdfGroup(std::string name) : name_(std::move(name)) {}

  /// A dimension with its coordinates: the variable of its name, as readers of NetCDF take them. The same one twice is one.
  void add_dimension(NetcdfVariable coordinates);
  /// A variable whose dimensions are there; a name that is taken already gets underscores until it is not. Returns the name.
  std::string add(NetcdfVariable variable);
  void add_attribute(std::string name, std::string value) { attributes_.emplace_back(std::move(name), std::move(value)); }

  std::string const& name() const { return name_; }
  bool has_dimension(std::string const& name) const;
  /// Whether there is nothing beside dimensions.
  bool empty() const { return variables_.size() == dimensions_.size(); }
  std::vector<std::pair<std::string, std::size_t>> const& dimensions() const { return dimensions_; }
  std::vector<NetcdfVariable> const& variables() const { return variables_; }
  Attributes const& attributes() const { return attributes_; }

 private:
  std::string name_;
  std::vector<std::pair<std::string, std::size_t>> dimensions_;
  std::vector<NetcdfVariable> variables_;
  Attributes attributes_;
  std::set<std::string> taken_;
};

/// The bytes of a NetCDF-4 file: `attributes` at the root, the groups below it. The same arguments give the same bytes.
std::string netcdf_bytes(Attributes const& attributes, std::vector<NetcdfGroup> const& groups);

}  // namespace sysid
