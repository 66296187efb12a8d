// Files of named arrays, as MATLAB, NetCDF and HDF5 have: what a format must say of them, and the record that this makes.
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "data/table/reading_rules.hpp"
#include "data/table/record_file.hpp"

namespace sysid {

struct Variable {
  std::string path;               // `force`, `data.force`, `run/force`
  std::vector<std::size_t> size;  // per dimension, the slowest first
  std::string refused;            // why it cannot be a column: "is complex"; empty: its numbers can be read
  std::string unit;               // as the file states it; may be empty
};

/// Two functions make a format; both are called in a process of their own, which may crash and may throw.
struct VariableFormat {
  std::string_view name;  // "MATLAB file"
  std::vector<Variable> (*list)(std::string const& path);
  /// All numbers of a variable, the last dimension fastest; quiet NaN where one is missing.
  std::vector<double> (*read)(std::string const& path, std::string const& variable);
  /// Looks into the bytes of a file that cannot be listed: why, where that is known: "links to another file"; else empty. May be
  /// null.
  std::string (*refusal)(std::string_view bytes) = nullptr;
};

/// UserError E4023 where the file is damaged. Columns are named by their paths; of a matrix `X[:, 2]` is a column and `X[2, :]` a
/// row, counted from 1. rules: of them `missing` alone, whose numbers stand for missing samples as NaN does.
std::unique_ptr<RecordFile> open_variables(VariableFormat const& format, std::string path, std::string const& bytes,
                                           std::string digest, ReadingRules const& rules = {});

}  // namespace sysid
