// Functions that make or take vectors and matrices: sum, dot, transpose, diagonal, ...
#pragma once
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "check/elaborate/array.hpp"
#include "check/elaborate/whole_number.hpp"

namespace sysid {

struct ArrayFunctionRow {
  std::string_view name;
  std::string_view usage;    // "sum(v)"
  std::string_view summary;  // one line for `sysid list functions`
  /// Nothing when the arguments do not fit (without a diagnostic) or a diagnostic was added.
  std::optional<Array> (*apply)(ArrayAlgebra&, std::vector<Array>&, std::vector<long> const& sizes, Span);
  bool takes_sizes = false;  // its arguments are whole numbers
};

std::span<ArrayFunctionRow const> array_functions();
/// Null for any other name.
ArrayFunctionRow const* find_array_function(std::string_view name);

}  // namespace sysid
