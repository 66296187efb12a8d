// Bytes of files, without flushing them to the disk, which would take all of the time.
#pragma once
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace sysid::fuzz {

inline void put(std::filesystem::path const& path, std::string const& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

inline std::string bytes_of(std::filesystem::path const& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace sysid::fuzz
