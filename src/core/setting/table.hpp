// Tables of rows that have a name: what the language can name is a row somewhere.
#pragma once
#include <iterator>
#include <string_view>

namespace sysid {

/// The row of that name; null where there is none.
template <typename Rows>
auto row_named(Rows const& rows, std::string_view name) -> decltype(&*std::begin(rows)) {
  for (auto const& row : rows)
    if (row.name == name) return &row;
  return nullptr;
}

}  // namespace sysid
