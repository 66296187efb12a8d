// Shapes in words.
#include "syntax/shape.hpp"

#include <fmt/format.h>

namespace sysid {

std::string Shape::text() const {
  if (rank == 0) return "a number";
  if (rank == 1) return fmt::format("a vector of {}", rows);
  return fmt::format("a {} by {} matrix", rows, columns);
}

Shape vector_of(int rows) { return {1, rows, 1}; }

Shape matrix_of(int rows, int columns) { return {2, rows, columns}; }

}  // namespace sysid
