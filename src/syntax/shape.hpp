// Whether a quantity is a number, a vector or a matrix.
#pragma once
#include <cstddef>
#include <string>

namespace sysid {

/// rank 0: a number; 1: a vector of `rows`; 2: a matrix. A vector counts as a column.
struct Shape {
  int rank = 0;
  int rows = 1, columns = 1;

  std::size_t count() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }
  /// "a number", "a vector of 3", "a 2 by 3 matrix".
  std::string text() const;
  friend bool operator==(Shape const&, Shape const&) = default;
};
Shape vector_of(int rows);
Shape matrix_of(int rows, int columns);

}  // namespace sysid
