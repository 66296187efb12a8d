// Fuzzer: any bytes as a model text.
#include <cstdint>

#include "fuzz/stages.hpp"

extern "C" int LLVMFuzzerTestOneInput(std::uint8_t const* bytes, std::size_t size) {
  sysid::fuzz::text(std::string(reinterpret_cast<char const*>(bytes), size));
  return 0;
}
