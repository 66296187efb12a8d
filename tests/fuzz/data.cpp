// Fuzzer: any bytes as a data file.
#include <cstdint>

#include "fuzz/stages.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* bytes, std::size_t size) {
  sysid::fuzz::data(std::string(reinterpret_cast<char const*>(bytes), size));
  return 0;
}
