// The size is looked at before the bytes are read.
#include "data/table/record_bytes.hpp"

#include <fmt/format.h>

#include "core/system/files.hpp"
#include "core/system/memory.hpp"

namespace sysid {

std::string read_record_bytes(std::string const& path) {
  constexpr double large = 1e8;          // bytes: of less nobody runs out of memory
  constexpr double memory_per_byte = 3;  // of a file: its text, where its cells begin, its numbers
  double const size = static_cast<double>(regular_file_size(path));
  if (size > large)
    require_memory(fmt::format("reading `{}`", path), memory_per_byte * size,
                   "cut the record, or remove columns that are not used");
  return read_regular_file(path);
}

}  // namespace sysid
